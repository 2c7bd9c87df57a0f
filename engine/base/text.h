// Small things about words: which known word a mistyped one is nearest to, and times as people read them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace supple {

// The candidate with the smallest edit distance to `word`; empty when none is near enough to be what was meant.
std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates);

// "mu, lambda or nu"
std::string word_list(const std::vector<std::string>& words);

// "7.4 s", "2 min 05 s"
std::string duration_text(double seconds);

}  // namespace supple
