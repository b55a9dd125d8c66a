#include "common/evaluation/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "common/base/text.h"
#include "common/evaluation/plot_view.h"

namespace pangaea {
namespace {

constexpr const char* kBackground = "#f6f5f1";
constexpr const char* kPaper = "#ffffff";
constexpr const char* kInk = "#22262e";
constexpr const char* kFaintInk = "#6b7280";
// Distinct also for colour-blind readers, one after the other.
constexpr std::array kColours = {"#1769d6", "#e2582b", "#159a72", "#8a3fb5",
                                 "#d99a00", "#0e9bb5", "#c22a68", "#6d4c41"};
// Landmarks from the lowest to the highest.
constexpr std::array kShades = {"#39466b", "#4b6288", "#6580a0", "#869db3", "#a5b5bf", "#bfc8c9"};
constexpr double kMargin = 28.0;         // pixels, around everything
constexpr double kHeader = 84.0;         // pixels, for the titles
constexpr double kFooter = 44.0;         // pixels, for the numbers of the horizontal axis
constexpr double kAxisWidth = 46.0;      // pixels, for those of the vertical one
constexpr double kLegendWidth = 290.0;   // pixels
constexpr double kLegendRow = 52.0;      // pixels
constexpr double kGridDistance = 110.0;  // pixels between grid lines, at least
constexpr double kLineStep = 0.5;        // pixels: nearer points of a line are left out

// An SVG document that grows.
class Svg {
 public:
  __attribute__((format(printf, 2, 3))) void Add(const char* format, ...) {
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(text, sizeof(text), format, arguments);
    va_end(arguments);
    text_ += text;
  }
  void AddText(double x, double y, double size, const char* style, const std::string& words) {
    Add("<text x=\"%.1f\" y=\"%.1f\" font-size=\"%.1f\" %s>", x, y, size, style);
    for (const char c : words) {
      text_ += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
    }
    text_ += "</text>\n";
  }
  std::string Take() { return std::move(text_); }

 private:
  std::string text_;
};

const char* ColourOf(std::size_t trajectory) { return kColours[trajectory % kColours.size()]; }

// 1, 2 or 5 times a power of ten.
double GridStep(double pixels_per_metre) {
  const double least = kGridDistance / pixels_per_metre;
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= least) return factor * power;
  }
  return 10.0 * power;
}

std::string Metres(double value, double step) {
  char text[32];
  const int decimals = step >= 1.0 ? 0 : static_cast<int>(std::ceil(-std::log10(step)));
  std::snprintf(text, sizeof(text), "%.*f", decimals, std::abs(value) < 0.5 * step ? 0.0 : value);
  return text;
}

void DrawGrid(const PlotView& view, Svg& svg) {
  const PlotView::Box& box = view.box();
  const double step = GridStep(view.pixels_per_metre());
  for (double x = std::ceil(view.low().x() / step) * step; x <= view.high().x(); x += step) {
    const double u = view.ToPixel(Eigen::Vector2d(x, 0.0)).x();
    svg.Add("<path d=\"M%.1f %.1fv%.1f\" stroke=\"#e7e6e1\"/>\n", u, box.top, box.height);
    svg.AddText(u, box.top + box.height + 20.0, 12.5, "text-anchor=\"middle\" fill=\"#6b7280\"", Metres(x, step));
  }
  for (double y = std::ceil(view.low().y() / step) * step; y <= view.high().y(); y += step) {
    const double v = view.ToPixel(Eigen::Vector2d(0.0, y)).y();
    svg.Add("<path d=\"M%.1f %.1fh%.1f\" stroke=\"#e7e6e1\"/>\n", box.left, v, box.width);
    svg.AddText(box.left - 9.0, v + 4.0, 12.5, "text-anchor=\"end\" fill=\"#6b7280\"", Metres(y, step));
  }
  svg.AddText(box.left + box.width, box.top + box.height + 38.0, 12.5, "text-anchor=\"end\" fill=\"#6b7280\"",
              "metres, seen from above");
}

// All dots of one shade are one path of strokes without length and with round ends: the shortest way to write a dot.
void DrawLandmarks(const PlotScene& scene, const PlotView& view, const PlotOptions& options, Svg& svg) {
  struct Dot {
    Eigen::Vector2d pixel;
    double height;
  };
  std::vector<Dot> dots;
  const std::size_t stride = 1 + scene.landmarks.size() / std::max<std::size_t>(options.max_landmarks, 1);
  for (std::size_t i = 0; i < scene.landmarks.size(); i += stride) {
    const Eigen::Vector2d pixel = view.ToPixel(scene.landmarks[i]);
    if (scene.landmarks[i].allFinite() && view.Contains(pixel))
      dots.push_back({pixel, view.ToPlane(scene.landmarks[i]).z()});
  }
  std::ranges::stable_sort(dots, {}, &Dot::height);
  for (std::size_t shade = 0; shade < kShades.size(); ++shade) {
    svg.Add("<path stroke=\"%s\" stroke-width=\"2.1\" stroke-linecap=\"round\" opacity=\"0.55\" d=\"", kShades[shade]);
    const std::size_t end = dots.size() * (shade + 1) / kShades.size();
    for (std::size_t i = dots.size() * shade / kShades.size(); i < end; ++i) {
      svg.Add("M%.1f %.1fh0", dots[i].pixel.x(), dots[i].pixel.y());
    }
    svg.Add("\"/>\n");
  }
}

void DrawLine(const std::vector<Eigen::Vector3d>& points, const PlotView& view, const char* style, Svg& svg) {
  svg.Add("<path fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"round\" %s d=\"", style);
  Eigen::Vector2d last = Eigen::Vector2d::Constant(-1e9);
  bool is_first = true;
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector2d pixel = view.ToPixel(point);
    if (!pixel.allFinite() || (pixel - last).norm() < kLineStep) continue;
    svg.Add("%s%.1f %.1f", is_first ? "M" : "L", pixel.x(), pixel.y());
    last = pixel;
    is_first = false;
  }
  svg.Add("\"/>\n");
}

void DrawTrajectory(const PlotTrajectory& trajectory, const char* colour, const PlotView& view, Svg& svg) {
  char style[96];
  for (const auto& piece : trajectory.pieces) {
    DrawLine(piece, view, "stroke=\"#ffffff\" stroke-width=\"6\" opacity=\"0.75\"", svg);
    std::snprintf(style, sizeof(style), "stroke=\"%s\" stroke-width=\"2.3\"", colour);
    DrawLine(piece, view, style, svg);
  }
  for (const Eigen::Vector3d& keyframe : trajectory.keyframes) {
    const Eigen::Vector2d pixel = view.ToPixel(keyframe);
    if (!pixel.allFinite()) continue;
    svg.Add("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3\" fill=\"#fff\" stroke=\"%s\" stroke-width=\"1.4\"/>\n", pixel.x(),
            pixel.y(), colour);
  }
}

// On top of everything: where the truth coincides with the estimate it shows as a dashed line inside of it.
void DrawTruth(const PlotTrajectory& trajectory, const PlotView& view, Svg& svg) {
  if (trajectory.truth.empty()) return;
  DrawLine(trajectory.truth, view, "stroke=\"#1b1f27\" stroke-width=\"1\" stroke-dasharray=\"5 4\" opacity=\"0.65\"",
           svg);
}

void DrawEnds(const PlotTrajectory& trajectory, const char* colour, const PlotView& view, Svg& svg) {
  if (trajectory.pieces.empty() || trajectory.pieces.front().empty() || trajectory.pieces.back().empty()) return;
  const Eigen::Vector2d start = view.ToPixel(trajectory.pieces.front().front());
  const Eigen::Vector2d end = view.ToPixel(trajectory.pieces.back().back());
  if (!start.allFinite() || !end.allFinite()) return;
  svg.Add("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"7\" fill=\"%s\" stroke=\"#fff\" stroke-width=\"2\"/>\n", start.x(),
          start.y(), colour);
  svg.Add("<rect x=\"%.1f\" y=\"%.1f\" width=\"13\" height=\"13\" fill=\"%s\" stroke=\"#fff\" stroke-width=\"2\"/>\n",
          end.x() - 6.5, end.y() - 6.5, colour);
}

std::string LegendDetail(const PlotTrajectory& trajectory) {
  char text[64];
  std::string detail;
  if (trajectory.rms_error) {
    std::snprintf(text, sizeof(text), "ATE %.*f m", *trajectory.rms_error < 0.1 ? 4 : 3, *trajectory.rms_error);
    detail = text;
  }
  if (trajectory.keyframe_count) {
    detail += (detail.empty() ? "" : "  \xC2\xB7  ") + std::to_string(*trajectory.keyframe_count) + " keyframes";
  }
  return detail;
}

void DrawLegendSign(double x, double y, const char* sign, Svg& svg, const std::string& words) {
  svg.Add("<path d=\"M%.1f %.1fh30\" %s/>\n", x, y - 4.5, sign);
  svg.AddText(x + 44.0, y, 13.5, "fill=\"#6b7280\"", words);
}

void DrawLegend(const PlotScene& scene, double left, double top, Svg& svg) {
  double y = top + 12.0;
  bool has_truth = false;
  bool has_keyframes = false;
  for (std::size_t i = 0; i < scene.trajectories.size(); ++i) {
    const PlotTrajectory& trajectory = scene.trajectories[i];
    has_truth = has_truth || !trajectory.truth.empty();
    has_keyframes = has_keyframes || !trajectory.keyframes.empty();
    svg.Add("<path d=\"M%.1f %.1fh30\" stroke=\"%s\" stroke-width=\"5\" stroke-linecap=\"round\"/>\n", left, y - 1.0,
            ColourOf(i));
    svg.AddText(left + 44.0, y + 4.0, 17.0, "font-weight=\"600\" fill=\"#22262e\"", trajectory.name);
    svg.AddText(left + 44.0, y + 23.0, 13.5, "fill=\"#6b7280\"", LegendDetail(trajectory));
    y += kLegendRow;
  }
  svg.Add("<path d=\"M%.1f %.1fh%.1f\" stroke=\"#dddbd3\"/>\n", left, y - 8.0, kLegendWidth - 40.0);
  y += 18.0;
  if (has_truth) {
    DrawLegendSign(left, y, "stroke=\"#1b1f27\" stroke-width=\"1\" stroke-dasharray=\"5 4\"", svg, "ground truth");
    y += 25.0;
  }
  if (has_keyframes) {
    svg.Add("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3\" fill=\"#fff\" stroke=\"%s\" stroke-width=\"1.4\"/>\n", left + 15.0,
            y - 4.5, kFaintInk);
    svg.AddText(left + 44.0, y, 13.5, "fill=\"#6b7280\"", "keyframes");
    y += 25.0;
  }
  if (!scene.landmarks.empty()) {
    DrawLegendSign(left, y,
                   "stroke=\"#4b6288\" stroke-width=\"2.6\" stroke-linecap=\"round\" stroke-dasharray=\"0.1 6\"", svg,
                   std::to_string(scene.landmarks.size()) + " landmarks, darker below");
    y += 25.0;
  }
  svg.Add("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"5\" fill=\"%s\"/>\n", left + 7.0, y - 4.5, kFaintInk);
  svg.Add("<rect x=\"%.1f\" y=\"%.1f\" width=\"10\" height=\"10\" fill=\"%s\"/>\n", left + 18.0, y - 9.5, kFaintInk);
  svg.AddText(left + 44.0, y, 13.5, "fill=\"#6b7280\"", "start and end");
}

}  // namespace

std::string DrawSvg(const PlotScene& scene, const PlotOptions& options) {
  const double width = std::max(options.width, 640);
  const double height = std::max(options.height, 400);
  const PlotView view(scene, {.left = kMargin + kAxisWidth,
                              .top = kHeader,
                              .width = width - 2.0 * kMargin - kAxisWidth - kLegendWidth,
                              .height = height - kHeader - kFooter - kMargin});
  const PlotView::Box& box = view.box();
  Svg svg;
  svg.Add("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" viewBox=\"0 0 %.0f %.0f\" ", width,
          height, width, height);
  svg.Add("font-family=\"Helvetica Neue, Helvetica, Arial, DejaVu Sans, sans-serif\">\n");
  svg.Add("<rect width=\"100%%\" height=\"100%%\" fill=\"%s\"/>\n", kBackground);
  char style[96];
  std::snprintf(style, sizeof(style), "font-weight=\"700\" fill=\"%s\"", kInk);
  svg.AddText(box.left, 42.0, 25.0, style, scene.title);
  svg.AddText(box.left, 66.0, 14.5, "fill=\"#6b7280\"", scene.subtitle);
  svg.Add("<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" rx=\"6\" fill=\"%s\" stroke=\"#dddbd3\"/>\n",
          box.left, box.top, box.width, box.height, kPaper);
  svg.Add("<clipPath id=\"map\"><rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" rx=\"6\"/></clipPath>\n",
          box.left, box.top, box.width, box.height);
  DrawGrid(view, svg);
  svg.Add("<g clip-path=\"url(#map)\">\n");
  DrawLandmarks(scene, view, options, svg);
  for (std::size_t i = 0; i < scene.trajectories.size(); ++i) {
    DrawTrajectory(scene.trajectories[i], ColourOf(i), view, svg);
  }
  for (const PlotTrajectory& trajectory : scene.trajectories) DrawTruth(trajectory, view, svg);
  for (std::size_t i = 0; i < scene.trajectories.size(); ++i) {
    DrawEnds(scene.trajectories[i], ColourOf(i), view, svg);
  }
  svg.Add("</g>\n");
  DrawLegend(scene, box.left + box.width + 28.0, box.top + 8.0, svg);
  svg.Add("</svg>\n");
  return svg.Take();
}

Status WriteSvg(const std::filesystem::path& path, const PlotScene& scene, const PlotOptions& options) {
  return WriteTextFile(path, DrawSvg(scene, options));
}

}  // namespace pangaea
