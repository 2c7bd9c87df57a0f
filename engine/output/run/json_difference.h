// Describes to people how two JSON documents differ: "body.soft.material.mu: 4e4 and 5e4".
#pragma once

#include <string>
#include <vector>

namespace supple {

// Describes a value that is not the same in both documents.
struct JsonDifference {
  std::string path;  // leads into objects by key, and into lists by an element's "name" or its number from 0
  std::string a, b;  // as JSON; "nothing" where a document has no such value
};

// Lists the differences in the order of a, followed by values that only b has. List elements with a name are compared
// with those of the same name, others with those of the same number; lists of numbers and words count as one value.
// Texts that are not JSON differ as a whole.
std::vector<JsonDifference> differing_values(const std::string& a, const std::string& b);

// Gives the same differences as sentences, with long values shortened; at most `most` of them.
std::vector<std::string> json_differences(const std::string& a, const std::string& b, std::size_t most = 10);

}  // namespace supple
