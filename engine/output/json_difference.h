// In what two JSON documents differ, for people: "body.soft.material.mu: 4e4 and 5e4".
#pragma once

#include <string>
#include <vector>

namespace supple {

// A value that is not the same in both.
struct JsonDifference {
  std::string path;  // into objects by key and into lists by an element's "name", or its number from 0
  std::string a, b;  // as JSON; "nothing" where a document has no such value
};

// In the order of a, then what only b has. Elements of lists with a name of their own are held against those of the
// same name, others against those of the same number; lists of numbers and words are one value. Texts that are not JSON
// differ as a whole.
std::vector<JsonDifference> differing_values(const std::string& a, const std::string& b);

// The same as sentences, long values shortened; at most `most`.
std::vector<std::string> json_differences(const std::string& a, const std::string& b, std::size_t most = 10);

}  // namespace supple
