// Pieces of a page. Whatever text goes in is escaped here.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "report/figure.h"

namespace capsoc::report {

/// For text and for attributes in double quotes. Control characters other than the line's end and
/// the tabulator become a replacement character.
std::string escaped(std::string_view text);

/// A table as texts; a cell may be followed by a class of the style sheet.
struct Cell {
  std::string text;
  const char* style = "";  ///< "good", "bad", "odd"
  std::string exact = {};  ///< its title, where the text has not all digits
  Cell(std::string words) : text(std::move(words)) {}
  Cell(const char* words) : text(words) {}
  Cell(std::string words, const char* named) : text(std::move(words)), style(named) {}
};
struct Table {
  std::string caption;
  std::vector<std::string> head;
  std::vector<std::vector<Cell>> rows;
  bool is_exact = false;  ///< numbers with all of their digits, as settings have them
};

/// Sortable; nothing for a table without rows. A number has the digits that mean something; the
/// exact one is its title.
std::string html_of(const Table& table);

/// A heading with a place for links, and what stands below.
std::string section(const std::string& id, const std::string& title, const std::string& body);

std::string paragraph(const std::string& text);
std::string preformatted(const std::string& name, const std::string& text);
/// Side by side where there is room.
std::string columns(const std::string& items);

/// A figure with its plot, caption and legend; its data is elsewhere in the page.
std::string html_of(const Figure& figure, const Data& data);

/// The figure's data as the page's script reads it.
std::string json_of(const Figure& figure, const Data& data);

/// A text as JSON inside of a page's script.
std::string json_text(std::string_view text);

}  // namespace capsoc::report
