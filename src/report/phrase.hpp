#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace servoctl::report {

/// An fmt format string as a pattern of the texts that are made with it: literal pieces, and between them
/// what stood at the placeholders.
class Phrase {
 public:
  struct Place {
    std::size_t argument = 0;  ///< Which argument stands there, from 0; counted where none is written.
    bool number = false;       ///< Its format is that of a number.
    bool quoted = false;       ///< What stands there stays as it is: in '…' or `…`, or keep() says so.
    bool suffix = false;  ///< It stands right behind a letter: the `s` of a plural, which may be missing.
  };

  /// `{{` is `{`. What is no placeholder of fmt stays text: `${NAME}`.
  explicit Phrase(std::string_view format);

  /// What stands at the argument is a name, whatever word it looks like.
  void keep(std::size_t argument);

  const std::vector<std::string>& pieces() const { return pieces_; }  ///< One more than places().
  const std::vector<Place>& places() const { return places_; }
  /// Letters of the words in it.
  std::size_t letters() const { return letters_; }
  /// Bytes of its pieces.
  std::size_t size() const { return size_; }
  /// Words that are whole within a piece, so that they stand in each text of the pattern.
  std::vector<std::string_view> words() const;

  /// What stands at each of places() in `text`; nothing where the text is none of the pattern.
  std::optional<std::vector<std::string_view>> match(std::string_view text) const;

  /// The text with these values at its placeholders, one for each argument; those it does not have are
  /// empty.
  std::string with(const std::vector<std::string>& arguments) const;

 private:
  bool match_from(std::size_t piece, std::string_view rest, std::vector<std::string_view>& out,
                  std::size_t& steps) const;
  bool fits(std::size_t place, std::string_view value) const;
  void add_place(std::string_view inside);

  std::vector<std::string> pieces_{std::string()};
  std::vector<Place> places_;
  std::size_t letters_ = 0;
  std::size_t size_ = 0;
};

}  // namespace servoctl::report
