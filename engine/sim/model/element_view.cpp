#include "sim/model/element_view.h"

#include <array>
#include <vector>

namespace supple {

Tetrahedra tetrahedra_of(const Model& model) {
  std::vector<std::array<std::int32_t, 4>> rows;
  for_each_element(model, [&](const ElementView& element) {
    if (element.kind != ElementKind::tetrahedron || element.is_arm) return;
    rows.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) rows.back()[k] = element.corner[k];
  });
  Tetrahedra tets(std::ssize(rows), 4);
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (int k = 0; k < 4; ++k) tets(static_cast<Eigen::Index>(i), k) = rows[i][std::size_t(k)];
  return tets;
}

}  // namespace supple
