#pragma once
// Factors of the formulas that a test program changes one by one, to see that validation notices. The product is built
// without KERF_MUTATIONS: every factor is the constant 1.

namespace kerf {

enum class FormulaPart {
  Nothing,
  HoleProduct,
  HoleTrace,
  InclusionTrace,
  InclusionDeviator,
  InclusionMisfit,
  EllipseProduct,
  EllipseTrace,
  EllipseShorter,
  EllipseLonger,
  CrackNormal,
  CrackTangential,
  ClampedLogarithm,
  ClampedHalf,
  ClampedRegular,
  ClampedForce,
  PowerInside,
  PowerOutside,
  PowerSlope,
  PowerExterior,
  LocalDensity,
  Energy,
  Dual,
  Measured,
  BodyForce,
  SecondMeanGradient,
  SecondDeviatorGradient,
  SecondCurvature,
  SecondReplyMean,
  SecondReplyDeviator,
  SecondInclusion,
  SecondLogarithm,
  Count
};

#ifdef KERF_MUTATIONS
/// Which one is changed, and to what.
struct Mutation {
  FormulaPart factor = FormulaPart::Nothing;
  double to = 1;
};
inline Mutation mutation;
inline double mutant(FormulaPart f) {
  return f == mutation.factor ? mutation.to : 1;
}
#else
constexpr double mutant(FormulaPart) {
  return 1;
}
#endif

}  // namespace kerf
