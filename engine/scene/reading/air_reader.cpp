// Reads the wind of a scene, and what air and gas have to do with a body.
#include "scene/reading/table_readers.h"

namespace supple {

std::optional<Wind> read_wind(const ConfigTable& root, std::uint64_t seed) {
  const auto table = root.table({"wind", "", "the air that moves past the bodies; without it there is no air"});
  if (!table) return std::nullopt;
  Wind wind;
  wind.velocity = table->vector({"velocity", "m/s", "mean velocity of the air"}, wind.velocity);
  wind.gusts = table->number({"gusts", "", "root mean square of the gusts' speed, over the mean speed; from `seed`"},
                             0.2, Range::between(0, 10));
  wind.gust_length =
      table->number({"gust_length", "m", "of the largest gusts"}, wind.gust_length, Range::above(0, 1e6));
  wind.gust_period =
      table->number({"gust_period", "s", "in which the largest gusts pass"}, wind.gust_period, Range::above(0, 1e6));
  wind.density = table->number({"density", "kg/m^3", "of the air"}, wind.density, Range::between(0, 1e5));
  wind.seed = seed;
  return wind;
}

std::optional<DragCoefficients> read_drag(const ConfigTable& body) {
  const auto table = body.table(
      {"drag", "", "of the air on its surface: cloth has it in every scene with a [wind], solids where this is given"});
  if (!table) return std::nullopt;
  DragCoefficients drag;
  drag.normal = table->number({"normal", "", "for wind across the surface: a plate of area A gets normal rho A v^2/2"},
                              usual_drag.normal, Range::between(0, 1000));
  drag.tangent =
      table->number({"tangent", "", "for wind along the surface"}, usual_drag.tangent, Range::between(0, 1000));
  return drag;
}

std::optional<GasFilling> read_pressure(const ConfigTable& body) {
  const auto table = body.table({"pressure", "", "of gas in its surface, which must be closed"});
  if (!table) return std::nullopt;
  GasFilling gas;
  gas.gauge =
      table->number({"gauge", "Pa", "above the atmosphere's; of a fixed amount: at the volume of the rest shape"}, 0.0,
                    Range::above(-atmospheric_pressure, 1e12));
  gas.amount = table->word<GasAmount>(
      {"amount", "", "open: the pressure stays; fixed: no gas enters or leaves, and pressure times volume stays"},
      gas.amount);
  return gas;
}

}  // namespace supple
