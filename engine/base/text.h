// Small things about words: which known word a mistyped one is nearest to, times and sizes as people read them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace supple {

// The candidate with the smallest edit distance to `word`; empty when none is near enough to be what was meant.
std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates);

// "mu, lambda or nu"
std::string word_list(const std::vector<std::string>& words);

// "1 repeat", "3 repeats"
std::string count_text(long count, const std::string& what);

// "7.4 s", "2 min 05 s"
std::string duration_text(double seconds);

// "812 bytes", "4.1 kB", "12.3 MB", "1.2 GB": thousands, not 1024s
std::string bytes_text(std::uintmax_t bytes);

// The text on one line, with control characters spelt out ("\n", "\x1b"): for titles, names and messages that hold
// what a file says, which a terminal must not take for orders.
std::string printable(std::string_view text);

// The word as a shell reads it back: quoted where it has to be.
std::string shell_word(const std::string& word);

}  // namespace supple
