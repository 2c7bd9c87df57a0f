// Says how much waits during a walk through a tree of triangles.
#pragma once

namespace supple {

// The trees are balanced: 2^31 triangles make 31 levels, with one sibling waiting at each.
inline constexpr int tree_stack_size = 64;

}  // namespace supple
