# gnuplot docs/plots/stress-curves.gp, after the tests have written build/release/stress-curves.csv.
set terminal svg size 900,420 font "Lato,14" background "#ffffff"
set output "docs/stress-curves.svg"
set datafile separator ","
set multiplot layout 1,2
set xlabel "stretch"
set ylabel "axial stress f over mu"
set grid lc "#e4e4e4"
set key bottom right
set xrange [0.3:1.7]
set yrange [-8:8]
set title "Spline materials (figure 6), mu = lambda"
plot "build/release/stress-curves.csv" skip 1 using 1:3 with lines lw 2 lc "#d9822b" title "spline A", \
  "" skip 1 using 1:4 with lines lw 2 lc "#4c78a8" title "spline B", "" skip 1 using 1:2 with lines lw 2 dt 2 lc "#333333" title "Neo-Hookean"
set yrange [-2:2]
set title "Polynomial and two strain limits (figure 11)"
plot "build/release/stress-curves.csv" skip 1 using 1:5 with lines lw 2 lc "#d9822b" title "polynomial", \
  "" skip 1 using 1:6 with lines lw 2 lc "#4c78a8" title "two strain limits"
unset multiplot
