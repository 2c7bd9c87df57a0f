#include "base/names.h"

#include <gtest/gtest.h>

#include <set>

#include "film/plan/film_plan.h"
#include "geometry/skins/pattern.h"
#include "render/gl_context.h"
#include "scene/definition/keyed_motion.h"
#include "scene/definition/selection.h"
#include "scene/reading/sweep.h"
#include "sim/model/inputs.h"
#include "sim/model/method.h"
#include "sim/model/report.h"
#include "sim/model/start_matrix.h"
#include "sim/model/time_scheme.h"

namespace supple {
namespace names_test {

template <class E>
class NameTables : public testing::Test {};

using AllEnums = testing::Types<LineSearch, StopReason, ContactDirection, Integrator, Precision, Ease, Selection::Kind,
                                SweepMode, RampRule, Combine, Pattern, GlChoice, FilmPictures, StartMatrix,
                                LinearSolver, Preconditioner, Acceleration, Safeguard>;
TYPED_TEST_SUITE(NameTables, AllEnums);

TYPED_TEST(NameTables, GiveEveryValueBackByItsName) {
  const std::vector<std::string> names = all_names<TypeParam>();
  ASSERT_GE(names.size(), 2u);
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(value_named<TypeParam>(names[i]), static_cast<TypeParam>(i));
    EXPECT_EQ(name_of(static_cast<TypeParam>(i)), names[i]);
  }
  EXPECT_EQ(value_named<TypeParam>(""), std::nullopt);
}

}  // namespace names_test
}  // namespace supple
