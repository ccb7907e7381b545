#pragma once
// What passes between gmsh.cpp and the gmsh module: plain C data, so that the module may be loaded late.

#include <cstdint>

extern "C" {

/// What a geometry is meshed for. `outline`: coarse, each curve of it with at least `turn` edges a turn, for its
/// topology alone; otherwise as the geometry says, edges no longer than `size` (0: any length).
struct KerfGmshRequest {
  const char* geometry;
  const char* mesh;  // where to write it, format 4.1, binary
  bool outline;
  double size;
  int turn;
};

/// Points along a curve of a geometry, its ends among them (2 x points).
struct KerfGmshCurve {
  std::int32_t tag;
  std::int64_t points;
  const double* xy;
};

/// Loops of sides for a STEP file, one plane face: side k of a loop runs from start[k] to the next start, straight or
/// (arc[k]) around center[k], the shorter way. The first loop is the outline.
struct KerfGmshFace {
  std::int64_t loops;
  const std::int64_t* ends;  // of the sides of each loop
  const double* start;       // 2 x sides
  const bool* arc;
  const double* center;  // 2 x sides
};

using KerfGmshCurveSink = void (*)(void* target, const KerfGmshCurve* curve);
using KerfGmshErrorSink = void (*)(void* target, const char* message);
/// Return false after an error was told.
using KerfGmshMesher = bool (*)(const KerfGmshRequest* request, KerfGmshCurveSink curve, KerfGmshErrorSink error,
                                void* target);
using KerfGmshStep = bool (*)(const char* path, const KerfGmshFace* face, KerfGmshErrorSink error, void* target);
}
