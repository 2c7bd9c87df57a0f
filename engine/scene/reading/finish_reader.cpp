// Reads what bodies and colliders have in common of their looks besides colours.
#include "scene/reading/table_readers.h"

namespace supple {

Finish read_finish(const ConfigTable& table) {
  Finish finish;
  finish.roughness = table.number_if_given(
      {"roughness", "", "of the surface, 0 wet to 1 chalk; of painted layers where they have less gloss than that"},
      Range::between(0, 1));
  if (finish.roughness && table.has("gloss"))
    table.complain("roughness", "roughness: takes the place of 'gloss', so give one of them");
  finish.translucent = table.number(
      {"translucent", "", "share of the light behind it that comes through cloth, and through thin parts of a solid"},
      finish.translucent, Range::between(0, 1));
  return finish;
}

}  // namespace supple
