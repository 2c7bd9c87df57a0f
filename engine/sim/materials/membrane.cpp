#include "sim/materials/membrane.h"

namespace supple {

std::string_view name_of(const Membrane& membrane) {
  return std::visit([](const auto& m) { return m.name; }, membrane);
}

MembraneStiffness system_stiffness(const Membrane& membrane, double start, double end) {
  return std::visit(
      [&]<class M>(const M& m) -> MembraneStiffness {
        if constexpr (M::isotropic) {
          const double k = m.fitted_stiffness(start, end);
          return {{k, k}};
        } else {
          // (a . b)^2 is at most 2 (da . b)^2 + 2 (db . a)^2 around rest.
          return {{m.warp + m.shear, m.weft + m.shear}};
        }
      },
      membrane);
}

}  // namespace supple
