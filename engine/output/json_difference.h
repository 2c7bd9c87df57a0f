// In what two JSON documents differ, for people: "body.soft.material.mu: 4e4 and 5e4".
#pragma once

#include <string>
#include <vector>

namespace supple {

// Paths lead into objects by key and into lists by an element's "name", or its number from 0. At most `most`. Texts
// that are not JSON differ as a whole.
std::vector<std::string> json_differences(const std::string& a, const std::string& b, std::size_t most = 10);

}  // namespace supple
