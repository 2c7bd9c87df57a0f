// Reads what cloth is made of.
#include "scene/definition/fabrics.h"
#include "scene/reading/table_readers.h"

namespace supple {
namespace {

std::optional<FabricDef> read_fabric_preset(const ConfigTable& table, const Key& key) {
  std::vector<std::string> names;
  for (const FabricPreset& preset : fabric_presets) names.emplace_back(preset.name);
  const std::string name = table.choice(key, std::nullopt, {names});
  for (const FabricPreset& preset : fabric_presets) {
    if (name == preset.name) return FabricDef{preset.fabric(), preset.density};
  }
  return std::nullopt;
}

constexpr Key bend_key{"bend", "N m", "stiffness of cloth against bending: moment by width over curvature"};

template <class M>
Fabric read_elastic_sheet(const ConfigTable& table) {
  const double young =
      table.number({"young", "Pa", "Young's modulus at small strains"}, std::nullopt, Range::positive());
  const double poisson = table.number({"poisson", "", "Poisson's ratio"}, 0.3, Range::between(0, 0.495));
  const double thickness = table.number({"thickness", "m", "of the sheet"}, std::nullopt, Range::positive());
  const double compression =
      table.number({"compression", "", "share of the sheet's stiffness that is left where it would wrinkle"}, 1.0,
                   Range::between(0.001, 1));
  const double bend = table.number(bend_key, plate_stiffness(young, poisson, thickness), Range::at_least(0));
  return {M::from(PlaneLame::from_young(young, poisson, thickness), compression), bend};
}

// Reads a woven fabric. from: the fabric that has the numbers that the table does not give; null: numbers without a
// default must be given.
Fabric read_woven(const ConfigTable& table, const Fabric* from) {
  Woven woven = from != nullptr ? std::get<Woven>(from->membrane) : Woven();
  const auto given = [&](double value) { return from != nullptr ? std::optional(value) : std::nullopt; };
  woven.warp = table.number({"warp", "N/m", "stiffness along the grain"}, given(woven.warp), Range::positive());
  woven.weft = table.number({"weft", "N/m", "stiffness across the grain; that of the warp"},
                            from != nullptr ? woven.weft : woven.warp, Range::positive());
  woven.shear =
      table.number({"shear", "N/m", "stiffness against shear of the threads"}, given(woven.shear), Range::at_least(0));
  woven.compression = table.number({"compression", "", "share of the threads' stiffness below their length at rest"},
                                   woven.compression, Range::between(0.001, 1));
  woven.limit =
      table.number({"limit", "", "stretch above which threads are 20 times stiffer"}, woven.limit, Range::at_least(1));
  return {woven, table.number(bend_key, from != nullptr ? from->bending : 0.0, Range::at_least(0))};
}

}  // namespace

FabricDef read_fabric(const ConfigTable& owner) {
  FabricDef def;
  if (owner.is_text("material"))
    return read_fabric_preset(owner, {"material", "", "what the body is made of: a preset; of cloth a fabric"})
        .value_or(def);
  const auto table = owner.table({"material", "", "the energy and its parameters, or a preset"}, "required");
  if (!table) {
    if (!owner.has("material"))
      owner.complain(
          "'material' is missing: such as material = \"cotton\", or { model = \"woven\", warp = 1e4, shear = 50, bend "
          "= "
          "1e-5 }; or a stretch in the table `cloth`, for springs");
    return def;
  }
  if (table->has("fabric")) {
    const auto preset = read_fabric_preset(*table, {"fabric", "", "of cloth: the fabric that has the other numbers"});
    if (preset) def = {read_woven(*table, &preset->fabric), preset->usual_density};
    return def;
  }
  const std::string model = table->choice(
      {"model", "", "the energy of the sheet"}, std::nullopt,
      {{std::string(Woven::name), std::string(PlaneNeoHookean::name), std::string(PlaneStVenantKirchhoff::name)}});
  if (model == Woven::name) def.fabric = read_woven(*table, nullptr);
  if (model == PlaneNeoHookean::name) def.fabric = read_elastic_sheet<PlaneNeoHookean>(*table);
  if (model == PlaneStVenantKirchhoff::name) def.fabric = read_elastic_sheet<PlaneStVenantKirchhoff>(*table);
  return def;
}

}  // namespace supple
