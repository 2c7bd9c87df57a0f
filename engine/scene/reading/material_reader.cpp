// Reads materials and their presets.
#include "scene/definition/fabrics.h"
#include "scene/definition/presets.h"
#include "scene/reading/table_readers.h"

namespace supple {
namespace {

template <std::size_t... I>
std::vector<std::string> material_names(std::index_sequence<I...>) {
  return {std::string(std::variant_alternative_t<I, Material>::name)...};
}

const std::vector<std::string>& material_names() {
  static const std::vector<std::string> names =
      material_names(std::make_index_sequence<std::variant_size_v<Material>>());
  return names;
}

// Reads Young's modulus and Poisson's ratio, which can replace a model's own parameters. Returns nothing when they are
// absent.
std::optional<Lame> read_lame(const ConfigTable& table) {
  const auto young = table.number_if_given(
      {"young", "Pa", "Young's modulus at small strains, with poisson in the place of the model's parameters"},
      Range::positive());
  if (!young) {
    if (table.has("poisson"))
      table.complain("poisson", "poisson: only together with young, in the place of the model's parameters");
    return std::nullopt;
  }
  // At a Poisson's ratio of 0.5 lambda is infinite, and above 0.495 no mesh of this program resolves it. Below 0 lambda
  // is negative, and some energies have no lower bound.
  return Lame::from_young(
      *young, table.number({"poisson", "", "Poisson's ratio, with young"}, std::nullopt, Range::between(0, 0.495)));
}

SplineCurve read_curve(const ConfigTable& table, const Key& key) {
  std::vector<ControlPoint> points;
  for (const auto& [at, value] : table.pairs(key, 2, SplineCurve::most_points)) {
    // Slopes lose their digits between points that are closer together than a millionth.
    if (!points.empty() && at < points.back().at + 1e-6) {
      table.complain(key.name, fmt::format("{}: control points must stand in ascending order ({:g} follows {:g})",
                                           key.name, at, points.back().at));
      return {};
    }
    points.push_back({at, value});
  }
  return points.empty() ? SplineCurve() : SplineCurve(std::move(points));
}

// Reads the curves, or one of the presets, which are sampled from Neo-Hookean parameters.
Spline read_spline(const ConfigTable& table) {
  const std::string preset = table.choice({"preset", "", "A resists compression more than Neo-Hookean, B tension"},
                                          "none", {{"none", "A", "B"}});
  if (preset != "none") {
    const auto young = read_lame(table);
    Lame lame{1, 0};
    if (young) {
      lame = *young;
    } else {
      lame.mu = table.number({"mu", "Pa", "shear modulus, with a preset"}, std::nullopt, Range::positive());
      lame.lambda = table.number({"lambda", "Pa", "first Lame parameter, with a preset"}, 0.0, Range::at_least(0));
    }
    return preset == "A" ? Spline::preset_a(lame) : Spline::preset_b(lame);
  }
  Spline spline;
  for (const auto& curve : Spline::curves()) spline.*curve.value = read_curve(table, {curve.name, "Pa", curve.meaning});
  if (spline.a.empty()) {
    if (!table.has("a"))
      table.complain("'a' is missing: control points of the curve over a stretch, or preset = \"A\"");
    spline.a = SplineCurve({{0, -1}, {1, 0}});
  }
  return spline;
}

Range range_of(Sign sign) {
  switch (sign) {
    case Sign::positive: return Range::positive();
    case Sign::not_negative: return Range::at_least(0);
    case Sign::any: break;
  }
  return Range::any();
}

// Returns the value of a parameter that the file does not give; nothing where it must be given.
template <class M>
std::optional<double> fallback_of(const Parameter<M>& parameter) {
  if (parameter.fallback || parameter.sign == Sign::positive) return parameter.fallback;
  return 0;
}

template <class M>
M read_parameters(const ConfigTable& table) {
  M read;
  if constexpr (requires { M::from(Lame{}); }) {
    if (const auto lame = read_lame(table)) {
      for (const auto& p : M::parameters()) {
        if (table.has(p.name))
          table.complain(p.name, fmt::format("{}: not together with young and poisson, which say the same", p.name));
      }
      return M::from(*lame);
    }
  } else if (table.has("young") || table.has("poisson")) {
    table.complain("young", fmt::format("model '{}' has no Young's modulus and Poisson's ratio of its own", M::name));
  }
  for (const auto& p : M::parameters()) {
    read.*p.value = table.number({p.name, p.unit, p.meaning}, fallback_of(p), range_of(p.sign));
  }
  return read;
}

// Tells whether all required parameters are given. Otherwise a message about their values would make no sense.
template <class M>
bool all_given(const ConfigTable& table) {
  if (table.has("young")) return true;
  for (const auto& p : M::parameters()) {
    if (!fallback_of(p) && !table.has(p.name)) return false;
  }
  return true;
}

template <class M>
bool read_model(const ConfigTable& table, std::string_view model, Material& material) {
  if (M::name != model) return false;
  M read;
  if constexpr (requires { M::curves(); }) {
    read = read_spline(table);
  } else {
    read = read_parameters<M>(table);
  }
  if constexpr (requires { read.problem(); }) {
    const char* problem = read.problem();
    if (problem != nullptr && all_given<M>(table)) table.complain(problem);
  }
  material = read;
  return true;
}

template <std::size_t... I>
Material material_of(const ConfigTable& table, std::string_view model, std::index_sequence<I...>) {
  Material material;
  (void)(read_model<std::variant_alternative_t<I, Material>>(table, model, material) || ...);
  return material;
}

void read_preset(const ConfigTable& owner, SubstanceDef& substance) {
  std::vector<std::string> names;
  for (const MaterialPreset& preset : material_presets) names.emplace_back(preset.name);
  const std::string name = owner.choice({"material", "", "what the body is made of: a preset"}, std::nullopt, {names});
  for (const MaterialPreset& preset : material_presets) {
    if (name != preset.name) continue;
    substance.material = preset.material();
    substance.fibre.kappa = preset.fibre;
    substance.usual_density = preset.density;
  }
}

void read_fibre(const ConfigTable& owner, Fibre& fibre) {
  const auto table = owner.table({"fibre", "", "stiffness along one direction, on top of the material"});
  if (!table) return;
  fibre.kappa = table->number({"kappa", "Pa", "stiffness along the fibres"}, std::nullopt, Range::at_least(0));
  const Vec3 direction = table->vector(
      {"direction", "", "along the fibres, in the frame of the mesh or shape; any length"}, Vec3(0, 1, 0));
  if (direction.norm() < 1e-9) table->complain("direction", "direction: must not be zero");
  for (int i = 0; i < 3; ++i) fibre.direction[i] = direction.normalized()[i];
}

}  // namespace

std::string preset_in_full(const std::string& name) {
  for (const MaterialPreset& preset : material_presets) {
    if (name != preset.name) continue;
    return fmt::format("material = {{ model = \"{}\", young = {:g}, poisson = {:g} }}, density = {:g}{}",
                       name_of(preset.material()), preset.young, preset.poisson, preset.density,
                       preset.fibre > 0 ? fmt::format(", fibre = {{ kappa = {:g} }}", preset.fibre) : "");
  }
  for (const FabricPreset& preset : fabric_presets) {
    if (name == preset.name) return fmt::format("material = {{ fabric = \"{}\" }}", name);
  }
  return "";
}

SubstanceDef read_substance(const ConfigTable& owner) {
  SubstanceDef substance;
  if (owner.is_text("material")) {
    read_preset(owner, substance);
  } else if (const auto table =
                 owner.table({"material", "", "the energy and its parameters, or a preset"}, "required")) {
    const std::string model = table->choice({"model", "", "the energy"}, std::nullopt, {material_names()});
    substance.material = material_of(*table, model, std::make_index_sequence<std::variant_size_v<Material>>());
  } else if (!owner.has("material")) {
    owner.complain(
        "'material' is missing: such as material = \"rubber\", or { model = \"neo-hookean\", mu = 1e5, lambda = 4e5 }");
  }
  read_fibre(owner, substance.fibre);
  return substance;
}

}  // namespace supple
