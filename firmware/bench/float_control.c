// A motor's current controller: Clarke and Park transforms, two PI controllers with limits, and a
// duty cycle as an integer. Sine and cosine by polynomials. Many comparisons and conversions.
#include "bench.h"

enum { steps = 1500000 };

struct Controller {
  float p, i, limit, integral;
};

static float limited(float x, float limit) {
  if (x > limit) return limit;
  return x < -limit ? -limit : x;
}

static float control(struct Controller* c, float error) {
  c->integral = limited(c->integral + c->i * error, c->limit);
  return limited(c->p * error + c->integral, c->limit);
}

// Of an angle in turns, from -0.5 to 0.5 (a parabola, corrected).
static float sine(float turns) {
  const float magnitude = turns < 0 ? -turns : turns;
  const float rough = 8.0f * turns * (1.0f - 2.0f * magnitude);
  return rough + 0.225f * (rough * (rough < 0 ? -rough : rough) - rough);
}

int main(void) {
  struct Controller direct = {0.4f, 0.01f, 1.0f, 0}, quadrature = {0.4f, 0.01f, 1.0f, 0};
  uint32_t seed = 3, sum = 0;
  float angle = -0.5f, current_d = 0, current_q = 0;
  for (uint32_t step = 0; step < steps; ++step) {
    angle += 0.00731f;
    if (angle > 0.5f) angle -= 1.0f;
    const float s = sine(angle), c = sine(angle < 0.25f ? angle + 0.25f : angle - 0.75f);
    const float noise = (float)(int32_t)(next_random(&seed) & 0xFF) / 65536.0f;
    const float voltage_d = control(&direct, -current_d);
    const float voltage_q = control(&quadrature, 0.5f + noise - current_q);
    current_d += 0.05f * (voltage_d - current_d) + 0.01f * s * voltage_q;
    current_q += 0.05f * (voltage_q - current_q) - 0.01f * c * voltage_d;
    const int32_t duty = (int32_t)(1000.0f * (c * voltage_d - s * voltage_q));
    sum = sum * 33 + (uint32_t)duty;
  }
  return report("float_control", sum);
}
