// Compares the stages of a step with what a core could do at most (Williams, Waterman, Patterson 2009, "Roofline: an
// insightful visual performance model for multicore architectures").
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "app/bench/counted.h"
#include "app/bench/least_time.h"
#include "app/bench/sections.h"
#include "base/timing.h"
#include "sim/model/element_view.h"
#include "sim/model/system_solve.h"

namespace supple {
namespace {

// Returns the operations of one core in a loop of fused multiplications and additions that stays in registers [1/s].
// The compiler does not fuse by itself here, and would not use the widest registers.
template <class Number>
double peak_rate() {
  using Register = typename Eigen::internal::packet_traits<Number>::type;
  constexpr int registers = 12, rounds = 200000;  // enough to hide the latency of an operation
  constexpr int lanes = Eigen::internal::packet_traits<Number>::size;
  volatile Number unknown = Number(1e-6);  // unknown to the compiler
  const Number little = unknown;
  const auto factor = Eigen::internal::pset1<Register>(1 + little), addend = Eigen::internal::pset1<Register>(little);
  Register sum[registers];
  std::fill(sum, sum + registers, factor);
  const double ms = least_ms(7, [&] {
    for (int round = 0; round < rounds; ++round) {
#pragma GCC unroll 16  // otherwise the sums would be kept in memory
      for (Register& one : sum) one = Eigen::internal::pmadd(one, factor, addend);
    }
  });
  volatile Number used = 0;
  for (const Register& one : sum) used = used + Eigen::internal::pfirst(one);
  return 2.0 * lanes * registers * rounds / (1e-3 * ms);
}

// Returns how fast one core reads so many bytes again and again, from the cache or memory that holds them [bytes/s].
double read_rate(double bytes) {
  const auto count = std::max<Eigen::Index>(512, Eigen::Index(bytes / sizeof(double)));
  const Eigen::ArrayXd numbers = Eigen::ArrayXd::Constant(count, 1.5);
  const int rounds = std::max(1, static_cast<int>(3e7 / double(count * sizeof(double))));
  volatile double used = 0;
  const double ms = least_ms(7, [&] {
    for (int round = 0; round < rounds; ++round) used = used + numbers.sum();
  });
  return double(rounds) * double(count * sizeof(double)) / (1e-3 * ms);
}

// Counts the operations of one tetrahedron's energy and forces; nothing for splines, which look up their curves.
template <class M>
std::optional<double> operations_of(const M& material, const ElementView& element, const Positions& x) {
  if constexpr (std::is_same_v<M, Spline>) {
    return std::nullopt;
  } else {
    Counted corners[4][3], field[Tetrahedron::fields], force[3][3];
    for (int k = 0; k < 4; ++k)
      for (int i = 0; i < 3; ++i) corners[k][i] = Counted(x(element.corner[std::size_t(k)], i));
    for (int i = 0; i < Tetrahedron::fields; ++i) field[i] = Counted(element.field[std::size_t(i)]);
    Counted::operations = 0;
    (void)TetrahedronFormula<M, false>(material, nullptr).energy(corners, field, force);
    return double(Counted::operations);
  }
}

// Returns the mean number of operations over the elements of a body.
std::optional<double> operations_an_element(const Model& model, const Positions& x) {
  double sum = 0;
  bool known = true;
  for_each_element(model, [&](const ElementView& element) {
    const auto one = std::visit([&](const auto& material) { return operations_of(material, element, x); },
                                model.materials[std::size_t(element.region)]);
    known &= one.has_value();
    sum += one.value_or(0);
  });
  return known ? std::optional(sum / model.elements) : std::nullopt;
}

// Holds a part of a step: its time, and the bytes and operations that it cannot do without.
struct Stage {
  const char* name;
  Precision precision;
  double ms = 0, bytes = 0;
  std::optional<double> operations = {};
};

// Holds the operations of one core in each precision [1/s].
struct Peak {
  double single, twice;
  double at(Precision precision) const { return precision == Precision::single_precision ? single : twice; }
};

template <class List>
double bytes_of(const List& list) {
  return double(sizeof(*list.data())) * double(list.size());
}

Stage evaluation(const Model& model, OpenWorkspace& w, Precision precision) {
  const bool is_single = precision == Precision::single_precision;
  Stage stage{is_single ? "evaluate, single" : "evaluate", precision};
  w.elements = precision;
  stage.ms = least_ms(25, [&] { evaluate(model, w, w.current, Wanted::gradient); });
  w.elements = Precision::double_precision;
  stage.bytes = (is_single ? bytes_of(model.single_field) : bytes_of(model.field)) + bytes_of(model.corner) +
                bytes_of(model.chunk_vertex) + bytes_of(model.slots) + bytes_of(model.slot_begin) +
                2 * bytes_of(w.force) + bytes_of(w.current.energy) + bytes_of(w.current.x) + bytes_of(w.y) +
                bytes_of(model.mass) + bytes_of(w.current.gradient);
  if (const auto element = operations_an_element(model, w.current.x))
    stage.operations = *element * model.elements + 3.0 * double(model.slots.size()) + 12.0 * model.free;
  return stage;
}

Stage solve(const Model& model, OpenWorkspace& w) {
  Stage stage{"solve", model.factor.precision()};
  const Positions right = w.current.gradient;
  Positions solution = right;
  stage.ms = least_ms(25, [&] { solve_system(model, right, solution, w.solve_scratch); });
  const auto numbers = double(model.factor.stored_numbers());
  const double size = model.factor.precision() == Precision::single_precision ? sizeof(float) : sizeof(double);
  stage.bytes = 2 * size * numbers + 2 * bytes_of(right);  // the factor is read on the way forward and on the way back
  stage.operations = 2 * 2 * 3 * numbers;
  return stage;
}

// Takes the time from a step, where the recursion stands between the solves (Nocedal and Wright 2006, algorithm 7.4).
Stage recursion(const Model& model, const StepInputs& inputs, const State& before, OpenWorkspace& w) {
  Stage stage{"L-BFGS", Precision::double_precision, 1e300};
  for (int i = 0; i < 9; ++i) {
    State state = before;
    const StepReport& report = step(model, inputs, state, w);
    stage.ms = std::min(stage.ms, report.lbfgs_ms / std::max(1, report.iterations));
  }
  const double vector = bytes_of(w.current.gradient), pairs = inputs.solver.history;
  stage.bytes = 4 * pairs * vector;  // each s and t is read for its product and for its addition
  stage.operations = 8 * pairs * vector / sizeof(double);
  return stage;
}

void add_rows(ReportTable& table, const Subject& subject, const std::vector<Stage>& stages, const Peak& peaks) {
  for (const Stage& stage : stages) {
    const double rate = read_rate(stage.bytes), seconds = 1e-3 * stage.ms, peak = peaks.at(stage.precision);
    const double bound = std::max(stage.bytes / rate, stage.operations.value_or(0) / peak);
    const bool by_memory = stage.bytes / rate >= stage.operations.value_or(0) / peak;
    table.rows.push_back({subject.choice.scene + ", " + subject.choice.body, number_text(subject.model().vertices),
                          stage.name, number_text(stage.ms), number_text(1e-6 * stage.bytes),
                          stage.operations ? number_text(1e-6 * *stage.operations) : "",
                          number_text(1e-9 * stage.bytes / seconds), number_text(1e-9 * rate),
                          stage.operations ? number_text(1e-9 * *stage.operations / seconds) : "",
                          stage.operations ? (by_memory ? "memory" : "arithmetic") : "",
                          stage.operations ? number_text(bound / seconds) : ""});
  }
}

// Returns the time of the kernels for one tetrahedron, without what is done by vertex [ns].
double element_time(const Model& model, const Positions& x, Precision precision) {
  const ElementKernels& kernels = element_kernels();
  const auto elements = precision == Precision::single_precision ? kernels.elements_single : kernels.elements;
  AlignedVector<double> energy(std::size_t(model.blocks) * block_width), force(model.chunk_vertex.size() * list_stride),
      local(std::size_t(model.largest_chunk) * list_stride);
  const double ms = least_ms(25, [&] {
    for (std::size_t c = 0; c < model.chunks.size(); ++c) {
      const Model::ChunkRange& range = model.chunks[c];
      elements(model.chunk(int(c)), x.data(), nullptr, energy.data() + std::size_t(range.first_block) * block_width,
               force.data() + list_stride * std::size_t(range.first_vertex), local.data());
    }
  });
  return 1e6 * ms / model.elements;
}

// Compares materials on the elements of one body in one pose. The limit is that of the peak alone.
ReportTable elements_by_material(const Model& body, const Positions& x, const Peak& peaks) {
  ReportTable table{"elements", "Energy and forces of one tetrahedron by material, on one thread"};
  table.columns = {"material",
                   "double [ns]",
                   "single [ns]",
                   "single / double",
                   "double, at the peak [ns]",
                   "single, at the peak [ns]"};
  const Lame lame{3e4, 7e4};  // [Pa]
  const std::vector<Material> materials = {AsRigidAsPossible{lame.mu},    Polynomial{100 * lame.mu},
                                           Corotated::from(lame),         FixedCorotated::from(lame),
                                           StVenantKirchhoff::from(lame), NeoHookean::from(lame),
                                           StableNeoHookean::from(lame),  MooneyRivlin::from(lame),
                                           Spline::preset_a(lame),        StrainLimiting{lame.mu, 0.9, 1.1}};
  Model model = body;
  for (const Material& material : materials) {
    std::fill(model.materials.begin(), model.materials.end(), material);
    const double plain = element_time(model, x, Precision::double_precision),
                 single = element_time(model, x, Precision::single_precision);
    const std::optional<double> operations = operations_an_element(model, x);
    const auto limit = [&](Precision precision) {
      return operations ? number_text(1e9 * *operations / peaks.at(precision)) : "";
    };
    table.rows.push_back({std::string(name_of(material)), number_text(plain), number_text(single),
                          number_text(single / plain), limit(Precision::double_precision),
                          limit(Precision::single_precision)});
  }
  return table;
}

}  // namespace

ReportSection bench_roofline(const BenchSetting& setting) {
  const Peak peak{peak_rate<float>(), peak_rate<double>()};
  ReportSection section{"roofline", "Bytes and operations by stage, and what this machine could do"};
  ReportTable table{"roofline", "One evaluation, one solve, one recursion of L-BFGS, on one thread"};
  table.columns = {"body",
                   "vertices",
                   "stage",
                   "time [ms]",
                   "data [MB]",
                   "operations [million]",
                   "reached [GB/s]",
                   "read loop of that size [GB/s]",
                   "reached [GFLOP/s]",
                   "bound by",
                   "share of the bound"};
  ReportTable by_material;
  for (const SubjectChoice& choice :
       std::vector<SubjectChoice>{{"twisting-bar", "bar"},
                                  {"squirrel", "polynomial"},
                                  {"squirrel", "soft"},
                                  {"squirrel", "polynomial", {"body.polynomial.vertices=33000"}}}) {
    Subject subject(choice);
    say_doing(setting, fmt::format("{}: {}", choice.scene, subject.size_text()));
    const BenchState state = states_of(subject, {20}, setting).front();
    const StepInputs inputs = subject.inputs(state);
    OpenWorkspace w;
    const Stage lbfgs = recursion(subject.model(), inputs, state.before, w);
    const Stage plain = evaluation(subject.model(), w, Precision::double_precision),
                single = evaluation(subject.model(), w, Precision::single_precision);
    add_rows(table, subject, {plain, single, solve(subject.model(), w), lbfgs}, peak);
    if (choice.body == "soft") by_material = elements_by_material(subject.model(), w.current.x, peak);
  }
  section.tables = {std::move(table), std::move(by_material)};
  section.text = fmt::format(
      "A loop of fused multiplications and additions in registers makes {:.1f} GFLOP/s in double and {:.1f} in single "
      "precision on one core here. Data are what a stage must read and write at least once each time; the read loop "
      "goes "
      "over as many bytes again and again, so that it finds them in the same cache. Operations of elements are counted "
      "by a number type, a fused one as two; those of a solve, whose factor has single precision, are two for each "
      "stored number, right-hand side and way. The bound is the longer of data over the read loop's rate and "
      "operations "
      "over the peak.",
      1e-9 * peak.twice, 1e-9 * peak.single);
  return section;
}

}  // namespace supple
