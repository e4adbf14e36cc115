#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace pugi {
class xml_document;
struct xml_node_struct;
}  // namespace pugi

namespace servoctl::od {

class XmlDocument;

/// Where something stands in a text; both from 1, the column in bytes.
struct TextPlace {
  std::uint32_t line = 1;
  std::uint32_t column = 1;
};

/// An element of an XmlDocument, which must outlive it and stay where it is. An empty one stands for what is
/// not there: it has no text, attributes or children.
class XmlElement {
 public:
  XmlElement() = default;
  explicit operator bool() const { return node_ != nullptr; }

  std::string_view name() const;
  /// Its first text, without spaces around it.
  std::string_view text() const;
  /// The value of an attribute, without spaces around it; empty where it is not there.
  std::string_view attribute(const char* name) const;
  XmlElement child(const char* name) const;
  /// The children of this name, in their order, so many at most.
  std::vector<XmlElement> children(const char* name, std::size_t most = static_cast<std::size_t>(-1)) const;
  XmlElement parent() const;
  TextPlace place() const;

 private:
  friend class XmlDocument;
  XmlElement(const XmlDocument* document, pugi::xml_node_struct* node) : document_(document), node_(node) {}

  const XmlDocument* document_ = nullptr;
  pugi::xml_node_struct* node_ = nullptr;
};

/// An XML text as a tree. Entities a file defines itself are not replaced, and nothing outside of it is read.
class XmlDocument {
 public:
  /// Far above any device description; what has more is refused unread.
  static constexpr std::size_t kMostTags = 4'000'000;

  /// `text` is UTF-8. Errc::file with line and column when it is not well-formed or has too many tags.
  static Result<XmlDocument> parse(std::string_view text, std::string_view file);

  XmlDocument(XmlDocument&&) noexcept;
  XmlDocument& operator=(XmlDocument&&) noexcept;
  ~XmlDocument();

  XmlElement root() const;
  /// Whether the text declares a document type, which nothing here needs.
  bool declares_type() const { return declares_type_; }

 private:
  friend class XmlElement;
  XmlDocument();
  TextPlace place_at(std::size_t offset) const;
  void find_lines(std::string_view text);

  std::unique_ptr<pugi::xml_document> document_;
  std::vector<std::size_t> line_starts_;
  bool declares_type_ = false;
};

}  // namespace servoctl::od
