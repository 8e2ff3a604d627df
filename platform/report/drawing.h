// The plot of a figure as SVG. This is the only renderer of a figure: `--plot` writes it as a
// picture, and a page has the same elements inline, so they are there without a script, on paper
// and at load. The page's script adds no element of its own to the plot: it rewrites the places of
// these paths and ticks when a reader zooms, from the exact points that the page holds as JSON.
#pragma once

#include <string>

#include "report/figure.h"
#include "report/scale.h"

namespace capsoc::report {

/// Presentation attributes give the colours on white; classes let a page's style sheet give others.
class Drawing {
 public:
  Drawing(const Figure& figure, const Data& data);

  /// On white with title and legend, and with the caption for screen readers.
  std::string picture() const;
  /// Axes and curves alone: a page has title and legend as texts.
  std::string plot() const;

 private:
  double level(std::size_t number, double value) const;
  long across(double value) const;
  long up(double value) const;
  std::string axes() const;
  std::string ticks() const;
  std::string bar_labels() const;
  std::string names() const;
  std::string curves() const;
  std::string curve(std::size_t number) const;
  std::string path(std::size_t number) const;
  std::string bars(std::size_t number) const;
  std::string spread(std::size_t number) const;
  std::string legend(int& rows) const;

  const Figure& figure_;
  const Data& data_;
  Scale x_, y_;
  double height_;  ///< of the area between the axes
};

/// Whether a column's values are positive and span decades, so that its axis is logarithmic.
bool spans_decades(const Column& column);

}  // namespace capsoc::report
