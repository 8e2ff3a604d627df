#include "estimator.h"

// Of a weight that nothing is known of, in units of the noise's variance.
#define UNKNOWN 1e9

void estimator_begin(struct estimator* state) {
  for (int i = 0; i < estimator_terms; ++i)
    for (int j = 0; j < estimator_terms; ++j) state->covariance[i][j] = i == j ? UNKNOWN : 0;
}

void estimator_update(struct estimator* state, double sine, double cosine, double u, double v) {
  const double x[estimator_terms] = {sine, cosine, 1};
  const double data[2] = {u, v};
  double projected[estimator_terms];  // P x
  double power = 1 - state->forgetting;
  for (int i = 0; i < estimator_terms; ++i) {
    projected[i] = 0;
    for (int j = 0; j < estimator_terms; ++j) projected[i] += state->covariance[i][j] * x[j];
    power += projected[i] * x[i];
  }
  const double share = 1 / power;
  for (int channel = 0; channel < 2; ++channel) {
    double* const w = state->weights[channel];
    double error = data[channel];
    for (int i = 0; i < estimator_terms; ++i) error -= w[i] * x[i];
    error *= share;
    for (int i = 0; i < estimator_terms; ++i) w[i] += projected[i] * error;
  }
  // One half is computed and both are written: the covariance stays symmetric.
  const double kept = 1 / (1 - state->forgetting);
  for (int i = 0; i < estimator_terms; ++i)
    for (int j = 0; j <= i; ++j) {
      double p = (state->covariance[i][j] - projected[i] * projected[j] * share) * kept;
      if (i == j) p += state->drift;
      state->covariance[i][j] = p;
      state->covariance[j][i] = p;
    }
}
