// Sine and cosine of an angle in degrees, with the same bits on every machine: a mathematics
// library chooses its code by the processor and rounds the last bit as that comes out, and what is
// made of these numbers decides bytes of the result.
#pragma once

namespace voxweld {

struct SineCosine {
  double sine = 0, cosine = 1;
};

// Within 2^-52 of the true values; exact at multiples of 90 degrees, however large, and never -0.
// Precondition: degrees is finite.
SineCosine sine_cosine_of_degrees(double degrees);

}  // namespace voxweld
