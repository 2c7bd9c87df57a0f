// Reads what cloth is made of.
#include "scene/definition/fabrics.h"
#include "scene/reading/table_readers.h"

namespace supple {
namespace {

FabricDef read_fabric_preset(const ConfigTable& owner) {
  std::vector<std::string> names;
  for (const FabricPreset& preset : fabric_presets) names.emplace_back(preset.name);
  const std::string name =
      owner.choice({"material", "", "what the body is made of: a preset; of cloth a fabric"}, std::nullopt, {names});
  for (const FabricPreset& preset : fabric_presets) {
    if (name == preset.name) return {preset.fabric(), preset.density};
  }
  return {};
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

Fabric read_woven(const ConfigTable& table) {
  Woven woven;
  woven.warp = table.number({"warp", "N/m", "stiffness along the grain"}, std::nullopt, Range::positive());
  woven.weft =
      table.number({"weft", "N/m", "stiffness across the grain; that of the warp"}, woven.warp, Range::positive());
  woven.shear =
      table.number({"shear", "N/m", "stiffness against shear of the threads"}, std::nullopt, Range::at_least(0));
  woven.compression = table.number({"compression", "", "share of the threads' stiffness below their length at rest"},
                                   woven.compression, Range::between(0.001, 1));
  woven.limit =
      table.number({"limit", "", "stretch above which threads are 20 times stiffer"}, woven.limit, Range::at_least(1));
  return {woven, table.number(bend_key, 0.0, Range::at_least(0))};
}

}  // namespace

FabricDef read_fabric(const ConfigTable& owner) {
  FabricDef def;
  if (owner.is_text("material")) return read_fabric_preset(owner);
  const auto table = owner.table({"material", "", "the energy and its parameters, or a preset"}, "required");
  if (!table) {
    if (!owner.has("material"))
      owner.complain(
          "'material' is missing: such as material = \"cotton\", or { model = \"woven\", warp = 1e4, shear = 50, bend "
          "= "
          "1e-5 }; or a stretch in the table `cloth`, for springs");
    return def;
  }
  const std::string model = table->choice(
      {"model", "", "the energy of the sheet"}, std::nullopt,
      {{std::string(Woven::name), std::string(PlaneNeoHookean::name), std::string(PlaneStVenantKirchhoff::name)}});
  if (model == Woven::name) def.fabric = read_woven(*table);
  if (model == PlaneNeoHookean::name) def.fabric = read_elastic_sheet<PlaneNeoHookean>(*table);
  if (model == PlaneStVenantKirchhoff::name) def.fabric = read_elastic_sheet<PlaneStVenantKirchhoff>(*table);
  return def;
}

}  // namespace supple
