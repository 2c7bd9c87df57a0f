// Defines the field that pictures show on bodies in colours, as a scene describes it.
#pragma once

#include <array>
#include <filesystem>
#include <optional>

#include <Eigen/Core>

#include "base/names.h"

namespace supple {

// Names the field that the surfaces of bodies show.
enum class FieldQuantity { none, stretch, compression, volume, energy, stress, speed, depth, force, distance };
template <>
struct Names<FieldQuantity> {
  static constexpr std::array table = {Name{FieldQuantity::none, "none"},
                                       Name{FieldQuantity::stretch, "stretch"},
                                       Name{FieldQuantity::compression, "compression"},
                                       Name{FieldQuantity::volume, "volume"},
                                       Name{FieldQuantity::energy, "energy"},
                                       Name{FieldQuantity::stress, "stress"},
                                       Name{FieldQuantity::speed, "speed"},
                                       Name{FieldQuantity::depth, "depth"},
                                       Name{FieldQuantity::force, "force"},
                                       Name{FieldQuantity::distance, "distance"}};
};

// Names how the range of a field is found where no numbers are given.
enum class FieldRange {
  usual,  // from the quantity and the bodies (film/pictures/surface_field.h)
  film,   // from the whole film, which only a drawing from saved motion knows
};
template <>
struct Names<FieldRange> {
  static constexpr std::array table = {Name{FieldRange::usual, "usual"}, Name{FieldRange::film, "film"}};
};

// Names the colours of a field.
enum class FieldColors { usual, viridis, blue_yellow, blue_orange };
template <>
struct Names<FieldColors> {
  static constexpr std::array table = {Name{FieldColors::usual, "usual"}, Name{FieldColors::viridis, "viridis"},
                                       Name{FieldColors::blue_yellow, "blue-yellow"},
                                       Name{FieldColors::blue_orange, "blue-orange"}};
};

struct FieldDef {
  FieldQuantity quantity = FieldQuantity::none;
  FieldRange range_by = FieldRange::usual;
  std::optional<Eigen::Vector2d> range;  // low and high, in the quantity's unit
  FieldColors colors = FieldColors::usual;
  bool legend = true;
  std::filesystem::path reference;  // folder of the run to which distances are measured
};

}  // namespace supple
