#pragma once
// What passes between vtk.cpp and the VTK module: plain C data, so that the module may be loaded late.

#include <cstdint>

extern "C" {

struct KerfVtkField {
  const char* name;
  bool per_cell;
  int components;
  std::int64_t count;
  const double* values;  // components x count
};

/// Triangles (no cell_ends; three entries per cell, or cell_ends and quadratic ones of six), or polylines whose entries
/// end at cell_ends[k], lone points when each has one.
struct KerfVtkData {
  std::int64_t points;
  const double* xy;  // 2 x points
  std::int64_t cells;
  const std::int32_t* entries;  // numbers of points, cell after cell
  const std::int32_t* cell_ends;
  std::int64_t fields;
  const KerfVtkField* field;
};

/// Hands the finished file to `sink` in one piece. Returns false when VTK refuses or memory runs out.
using KerfVtkSink = void (*)(void* target, const char* bytes, std::int64_t count);
using KerfVtkWriter = bool (*)(const KerfVtkData* data, KerfVtkSink sink, void* target);
}
