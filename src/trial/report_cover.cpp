#include "trial/report_cover.hpp"

#include <system_error>

#include "base/base64.hpp"
#include "base/file.hpp"
#include "base/format.hpp"
#include "base/printable.hpp"
#include "base/text.hpp"
#include "base/utf8.hpp"
#include "trial/verdict.hpp"

namespace servoctl::trial {
namespace {

constexpr std::size_t kLongestText = 120;      ///< Columns: two lines of the page.
constexpr std::size_t kLongestSignature = 40;  ///< Columns: a line of its part of the page.
constexpr std::size_t kMostSignatures = 8;     ///< They stay together on one sheet.
constexpr std::uintmax_t kLargestLogo = 1U << 20U;

constexpr std::string_view kPngBegin("\x89PNG\r\n\x1A\n\0\0\0\rIHDR", 16);
constexpr std::string_view kPngEnd("IEND\xAE\x42\x60\x82", 8);
constexpr std::string_view kJpegBegin("\xFF\xD8\xFF");
constexpr std::string_view kJpegEnd("\xFF\xD9");
constexpr std::string_view kSvgNamespace = "http://www.w3.org/2000/svg";

/// The text without blanks around it; nothing typed is nothing.
Result<std::string> line_of(std::string_view option, std::string_view typed, std::size_t longest) {
  const auto text = trim(typed);
  if (printable(text) != text)
    return fail(Errc::usage,
                message("{}: '{}' has characters that control or hide", option, as_it_is(printable(text))),
                "one line of plain text, in UTF-8");
  if (display_width(text) > longest)
    return fail(Errc::usage, message("{}: {} columns are too many for the page", option, display_width(text)),
                message("at most {}; a Chinese character takes two", longest));
  return std::string(text);
}

Result<std::vector<std::string>> names_of(std::string_view typed) {
  std::string list(typed);
  for (const std::string_view comma : {"，", "、"})
    for (auto at = list.find(comma); at != std::string::npos; at = list.find(comma))
      list.replace(at, comma.size(), ",");
  std::vector<std::string> out;
  for (const auto part : split(std::string_view(list), ',')) {
    auto name = line_of("--signatures", part, kLongestSignature);
    if (!name) return fail(name.error());
    if (name->empty())
      return fail(Errc::usage, message("--signatures: '{}' has a line for nobody", as_it_is(typed)),
                  "names with a comma between: Commissioning engineer,Customer");
    out.push_back(std::move(*name));
  }
  if (out.size() > kMostSignatures)
    return fail(Errc::usage, message("--signatures: {} lines do not fit", out.size()),
                message("at most {}", kMostSignatures));
  return out;
}

Result<std::vector<std::string>> signatures_of(const show::Desk& desk, const CoverWords& words) {
  if (equals_nocase(trim(words.signatures), "none")) return std::vector<std::string>();
  if (!words.signatures.empty()) return names_of(words.signatures);
  if (words.customer.empty()) return std::vector<std::string>();
  return std::vector{say(desk, "Commissioning engineer"), say(desk, "Customer")};
}

/// What may stand before the root of an XML document: byte order mark, declarations, comments.
std::string_view without_prologue(std::string_view xml) {
  if (xml.starts_with("\xEF\xBB\xBF")) xml.remove_prefix(3);
  for (;;) {
    xml = trim(xml);
    const bool is_comment = xml.starts_with("<!--");
    if (!is_comment && !xml.starts_with("<?") && !xml.starts_with("<!DOCTYPE")) return xml;
    const std::string_view ending = is_comment ? "-->" : ">";
    // Entities may be declared between brackets.
    const auto inner = xml.find_first_of("[>");
    const auto from = !is_comment && inner != std::string_view::npos && xml[inner] == '[' ? xml.find(']') : 0;
    const auto end = xml.find(ending, from);
    if (end == std::string_view::npos) return {};
    xml.remove_prefix(end + ending.size());
  }
}

bool is_svg(std::string_view text) {
  const auto root = without_prologue(text);
  return is_utf8(text) && root.starts_with("<svg") && root.find(kSvgNamespace) != std::string_view::npos;
}

struct Kind {
  std::string_view type;
  bool whole;
};

/// By what is in it, whatever the file is called.
Kind kind_of(std::string_view content) {
  if (content.starts_with(kPngBegin)) return {"image/png", content.find(kPngEnd) != std::string_view::npos};
  if (content.starts_with(kJpegBegin))
    return {"image/jpeg", content.rfind(kJpegEnd) != std::string_view::npos};
  if (!is_svg(content)) return {};
  const auto text = trim(content);
  return {"image/svg+xml", text.find("</svg>") != std::string_view::npos || text.ends_with("/>")};
}

Result<Logo> read_logo(const std::filesystem::path& path) {
  if (path.empty()) return Logo{};
  std::error_code error;
  // It is read when the line is checked, and again for the page.
  if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error))
    return fail(Errc::file, message("--logo: {} is no regular file", as_it_is(path.string())),
                "a picture: PNG, JPEG or SVG");
  const auto content = read_file(path, kLargestLogo);
  if (!content) {
    auto why = content.error();
    why.message = "--logo: " + why.message;
    if (why.hint.empty()) why.hint = "a picture of at most 1 MiB: PNG, JPEG or SVG";
    return fail(std::move(why));
  }
  const auto kind = kind_of(*content);
  if (kind.type.empty())
    return fail(Errc::file, message("--logo: {} is no PNG, JPEG or SVG", as_it_is(path.string())),
                "the content counts, not the name; an SVG is XML in UTF-8 whose root is <svg xmlns=\"…\">");
  if (!kind.whole)
    return fail(Errc::file, message("--logo: {} is cut short", as_it_is(path.string())),
                "copy the picture again");
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(content->data());
  return Logo{std::string(kind.type), to_base64(ByteSpan(bytes, content->size()))};
}

}  // namespace

Result<ReportCover> read_cover(const show::Desk& desk, const CoverWords& words) {
  ReportCover out;
  struct Line {
    std::string_view option;
    std::string_view typed;
    std::string* place;
  };
  const Line lines[] = {{"--title", words.title, &out.title},
                        {"--customer", words.customer, &out.customer},
                        {"--machine", words.machine, &out.machine},
                        {"--operator", words.operator_name, &out.operator_name}};
  for (const auto& line : lines) {
    auto text = line_of(line.option, line.typed, kLongestText);
    if (!text) return fail(text.error());
    *line.place = std::move(*text);
  }
  auto signatures = signatures_of(desk, words);
  if (!signatures) return fail(signatures.error());
  out.signatures = std::move(*signatures);
  auto logo = read_logo(words.logo);
  if (!logo) return fail(logo.error());
  out.logo = std::move(*logo);
  return out;
}

}  // namespace servoctl::trial
