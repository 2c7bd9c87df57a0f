// Offers small functions on words: the known word that is nearest to a mistyped one, and times and sizes as people read
// them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace supple {

// Returns the candidate with the smallest edit distance to `word`, or nothing when none is near enough to be what was
// meant.
std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates);

// Returns "; did you mean 'mu'?", with the candidate that is nearest; nothing where none is near.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);

// Gives "mu, lambda or nu".
std::string word_list(const std::vector<std::string>& words);

// Gives "'collar', 'left sleeve' and 3 more": each name once, in the order of the alphabet, at most thirty of them.
std::string name_list(std::vector<std::string> names);

// Returns the text with its ASCII capitals made small.
std::string lowercase(std::string_view text);

// Gives "1 repeat" or "3 repeats".
std::string count_text(long count, const std::string& what);

// Gives "7.4 s" or "2 min 05 s".
std::string duration_text(double seconds);

// Gives "812 bytes", "4.1 kB", "12.3 MB" or "1.2 GB"; the units are powers of 1000, not of 1024.
std::string bytes_text(std::uintmax_t bytes);

// Returns how many bytes the first character of a text in UTF-8 has; 0 where the text is empty or begins with bytes
// that are not UTF-8.
std::size_t first_character(std::string_view text);

// Puts the text on one line, with control characters and bytes that are not UTF-8 spelt out ("\n", "\x1b"). It serves
// titles, names and messages that quote a file: a terminal must not execute control characters from a file.
std::string printable(std::string_view text);

// Writes the word so that a shell reads it back, quoted where it has to be.
std::string shell_word(const std::string& word);

}  // namespace supple
