# gnuplot docs/plots/energies.gp, after the tests have written build/release/energies.csv.
set terminal svg size 900,420 font "Lato,14" background "#ffffff"
set output "docs/energies.svg"
set datafile separator ","
set multiplot layout 1,2
set xlabel "time in s"
set ylabel "energy in J"
set grid lc "#e4e4e4"
set xrange [0:8]
set key at graph 0.98,0.72
set yrange [-4:1]
set title "Swinging bars"
plot "build/release/energies.csv" skip 1 using 1:2 with lines lw 2 lc "#d9822b" title "backward Euler", \
  "" skip 1 using 1:4 with lines lw 2 lc "#59a14f" title "midpoint, 100 iterations", \
  "" skip 1 using 1:5 with lines lw 2 dt 2 lc "#333333" title "midpoint, 4 substeps", \
  "" skip 1 using 1:6 with lines lw 2 lc "#4c78a8" title "midpoint, damped"
set yrange [-10:150]
set key top left
set title "Midpoint with too few iterations"
plot "build/release/energies.csv" skip 1 using 1:3 with lines lw 2 lc "#b03a2e" title "midpoint, 10 iterations", \
  "" skip 1 using 1:2 with lines lw 2 lc "#d9822b" title "backward Euler, 10 iterations"
unset multiplot
