// Takes a text apart into lines and words, with their places, for the checks of surface files (checked_surface.h).
// Lines end with \n, \r\n or \r; blank ones are passed over.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace supple {

struct RowWord {
  std::string_view text;
  int column = 0;  // from 1
};

class TextRows {
 public:
  struct Rules {
    bool comments = false;   // '#' starts a comment
    bool continued = false;  // a backslash at the end of a line continues it
  };

  // The text must live as long as this object.
  TextRows(std::string_view text, std::string name, Rules rules);

  // Goes to the next line with a word on it. Returns false at the end.
  bool next();

  const std::vector<RowWord>& words() const { return words_; }
  // Returns the line without its end, with its comments; of a line that is continued, only the first part.
  std::string_view raw() const { return raw_; }
  int line() const { return line_; }          // the line number of the words; at the end, that of the last line
  std::size_t offset() const { return at_; }  // where the text after the line begins

  [[noreturn]] void refuse(const std::string& message) const;
  [[noreturn]] void refuse(int line, int column, const std::string& message) const;
  [[noreturn]] void refuse(const RowWord& word, const std::string& message) const;

  // These return the number that a word is, and refuse a word that is none. what: "a coordinate" or the like.
  double number(const RowWord& word, std::string_view what) const;  // may be nan or infinite
  double finite(const RowWord& word, std::string_view what) const;
  long long integer(const RowWord& word, std::string_view what) const;

 private:
  void split(std::string_view line);

  std::string_view text_, raw_;
  std::string name_;
  Rules rules_;
  std::vector<RowWord> words_;
  std::size_t at_ = 0;
  int line_ = 0, lines_ = 0;  // lines_: how many were passed so far
};

// Returns the number in a form that assimp reads: the word itself where it is plain, else the value with nine digits.
std::string plain_number(std::string_view word, double value);

}  // namespace supple
