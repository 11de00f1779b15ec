// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

/* An exported predictor in someone else's monitor: libstrainwave_predictor. C99 and C++.
 *
 * One object serves one thread at a time; several objects run side by side. Strings that are returned live as
 * long as the object. `error` may be NULL; otherwise it gets a sentence of at most `error_size` bytes with
 * its closing zero, or an empty one. No function ends the program or throws. */

/* NOLINTBEGIN(readability-identifier-naming): names of a C library */
#ifdef __cplusplus
extern "C" {
#endif

typedef struct strainwave_predictor strainwave_predictor;

/* The numbers never change their meaning. */
typedef enum {
  STRAINWAVE_OK = 0,
  STRAINWAVE_OUTSIDE_TRAINING = 1, /* values are filled in, and nothing is promised of them */
  STRAINWAVE_BAD_SIGNAL = 2,   /* rate, length, NaN, a dead or clipped sensor, swapped channels; values NaN */
  STRAINWAVE_BAD_ARGUMENT = 3, /* a NULL or a zero where there must be none */
  STRAINWAVE_FAILED = 4        /* memory, or the network's reader */
} strainwave_status;

/* An output in its unit, and the interval that holds `strainwave_predictor_coverage` of records. */
typedef struct {
  double value;
  double low;
  double high;
} strainwave_value;

/* Opens a folder that `strainwave export` wrote, and tests it: hashes of all files, and the network against
 * its golden vectors. NULL, with the file and what is wrong with it in `error`, if anything is not as
 * written. */
strainwave_predictor* strainwave_predictor_open(const char* folder, char* error, size_t error_size);

/* The same for one reducer, with its baseline: a file that `strainwave baseline` wrote. A predictor of
 * changes since a reducer's first records cannot do without, and `strainwave_predictor_open` refuses it. */
strainwave_predictor* strainwave_predictor_open_for(const char* folder, const char* baseline_file,
                                                    char* error, size_t error_size);

/* NULL is passed over. */
void strainwave_predictor_close(strainwave_predictor* predictor);

/* What a record must be like: channels by name in their order, samples a second, least samples. Names of
 * channels and outputs end in their unit ("accel_x_m_per_s2", "k2_Nm_per_rad"); NULL beyond the last one. */
size_t strainwave_predictor_channel_count(const strainwave_predictor* predictor);
const char* strainwave_predictor_channel_name(const strainwave_predictor* predictor, size_t channel);
double strainwave_predictor_sample_rate_hz(const strainwave_predictor* predictor);
size_t strainwave_predictor_least_samples(const strainwave_predictor* predictor);

size_t strainwave_predictor_output_count(const strainwave_predictor* predictor);
const char* strainwave_predictor_output_name(const strainwave_predictor* predictor, size_t output);
/* 1 where the outputs are classes: then a value is the probability of its class, without an interval (low and
 * high are the same number), and the greatest is the likeliest. */
int strainwave_predictor_tells_classes(const strainwave_predictor* predictor);
double strainwave_predictor_coverage(const strainwave_predictor* predictor);

/* Predicts from one window.
 *
 * channels        channel_count pointers to `samples` values each, m/s², in the order of the channels
 * sample_rate_hz  of these samples
 * values          gets output_count values
 * distance        may be NULL; gets how far the window lies from the training, above 1 is outside; NaN when
 * bad */
strainwave_status strainwave_predictor_run(strainwave_predictor* predictor, const double* const* channels,
                                           size_t samples, double sample_rate_hz, strainwave_value* values,
                                           double* distance, char* error, size_t error_size);

/* The same where the speed of the input shaft is known, in revolutions per minute, and steady to a hundredth
 * over the window: predictors from energies by order of that shaft need it. */
strainwave_status strainwave_predictor_run_at(strainwave_predictor* predictor, const double* const* channels,
                                              size_t samples, double sample_rate_hz, double input_speed_rpm,
                                              strainwave_value* values, double* distance, char* error,
                                              size_t error_size);

/* Under what the reducer runs from now on: torque at the output in Nm, speed of the input shaft in
 * revolutions per minute (that of `strainwave_predictor_run_at` comes first), temperature of the gear in
 * degrees Celsius; NaN for what is not known, as all are at first. A run that leaves the ranges of the
 * training is outside it. */
void strainwave_predictor_set_operating_point(strainwave_predictor* predictor, double output_torque_Nm,
                                              double input_speed_rpm, double temperature_degC);

#ifdef __cplusplus
}
#endif
/* NOLINTEND(readability-identifier-naming) */
