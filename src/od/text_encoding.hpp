#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace servoctl::od {

/// How the letters of a file are written. Nothing in an EDS says it; CiA 306-1 asks for ASCII.
enum class TextEncoding : std::uint8_t { utf8, utf16le, utf16be, gbk, cp1252, cp850, cp932, cp950, cp1251 };

/// `UTF-8`, `UTF-16LE`, `UTF-16BE`, `GBK`, `CP1252`, `CP850`, `CP932`, `CP950`, `CP1251`: the names that
/// iconv takes.
std::string_view name(TextEncoding encoding);
/// The name people know: `Shift-JIS (CP932)`, `Big5 (CP950)`; else as name().
std::string_view title(TextEncoding encoding);

/// Whether every byte means something in the encoding.
bool means_something(std::string_view bytes, TextEncoding encoding);

/// Tells the encoding by the first of these that holds:
/// a byte order mark; half of the bytes are NUL and all on the same side of their pairs (UTF-16); it is valid
/// UTF-8; most bytes above 0x7F are Russian words (CP1251), or stand in runs of two Chinese or Japanese
/// characters or more (GBK, CP950 or CP932, by what more of them are in; GBK when that is the same); more
/// letters of words are in 0x80-0x9F, where CP1252 has dashes and quotes, than above (CP850, and CP437, whose
/// letters are the same); CP1252. CP1251, CP950 and CP932 only where no byte is without meaning in them.
TextEncoding guess_encoding(std::string_view bytes);

/// A file's text in UTF-8. The view is of the file's own bytes where nothing had to be changed, else of
/// `buffer`.
struct DecodedText {
  TextEncoding encoding = TextEncoding::utf8;
  std::string buffer;
  std::size_t skipped_nuls = 0;  ///< NUL bytes that were left out.
  std::size_t odd_bytes = 0;     ///< Bytes without meaning, each one written out: `\x9D`.
  std::uint32_t line = 1;        ///< Of the first byte that is not ASCII, or the first NUL.
  std::uint32_t column = 1;
  bool own_bytes = true;  ///< Whether the file's bytes after the mark are the text.
  std::size_t mark = 0;   ///< Bytes of the byte order mark.

  std::string_view text(std::string_view bytes) const {
    return own_bytes ? bytes.substr(mark) : std::string_view(buffer);
  }
};

/// Never fails and loses no byte but NULs: what cannot be read is written out. Linear in the length.
DecodedText to_utf8(std::string_view bytes);
/// The same of bytes whose encoding is known.
DecodedText to_utf8(std::string_view bytes, TextEncoding encoding);

/// Whether more than one of 20 bytes at the beginning (16 KiB) is a control character no text has: an image,
/// a program, an archive.
bool is_binary(std::string_view bytes);

}  // namespace servoctl::od
