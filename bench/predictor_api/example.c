// SPDX-License-Identifier: Apache-2.0
/* An exported predictor in a program of one's own:
 *
 *   example EXPORTED SAMPLES.CSV RATE_HZ
 *
 * SAMPLES.CSV holds the channels' samples alone, a row a sample, in the order that the program prints. */
#include <stdio.h>
#include <stdlib.h>

#include <strainwave_predictor.h>

static double** allocate(size_t channels, size_t samples) {
  double** rows = malloc(channels * sizeof *rows);
  for (size_t k = 0; rows != NULL && k < channels; ++k) {
    rows[k] = malloc(samples * sizeof **rows);
    if (rows[k] == NULL) exit(3);
  }
  if (rows == NULL) exit(3);
  return rows;
}

static size_t read_samples(FILE* file, double** rows, size_t channels, size_t most) {
  size_t samples = 0;
  while (samples < most) {
    for (size_t k = 0; k < channels; ++k) {
      if (fscanf(file, k == 0 ? "%lf" : ",%lf", &rows[k][samples]) != 1) return samples;
    }
    ++samples;
  }
  return samples;
}

static int predict(strainwave_predictor* predictor, FILE* file, double rate_hz) {
  enum { MOST_SAMPLES = 1 << 20, MOST_OUTPUTS = 256 };
  const size_t channels = strainwave_predictor_channel_count(predictor);
  const size_t outputs = strainwave_predictor_output_count(predictor);
  double** rows = allocate(channels, MOST_SAMPLES);
  const size_t samples = read_samples(file, rows, channels, MOST_SAMPLES);
  strainwave_value values[MOST_OUTPUTS];
  double distance = 0.0;
  char error[400];
  const strainwave_status status = strainwave_predictor_run(predictor, (const double* const*)rows, samples, rate_hz,
                                                            values, &distance, error, sizeof error);
  for (size_t k = 0; k < channels; ++k) free(rows[k]);
  free(rows);
  if (error[0] != '\0') fprintf(stderr, "%s\n", error);
  for (size_t i = 0; i < outputs && status <= STRAINWAVE_OUTSIDE_TRAINING; ++i) {
    printf("%s %.17g %.17g %.17g\n", strainwave_predictor_output_name(predictor, i), values[i].value,
           values[i].low, values[i].high);
  }
  return (int)status;
}

int main(int argc, char** argv) {
  char error[400];
  strainwave_predictor* predictor;
  FILE* file;
  int status;
  if (argc != 4) {
    fprintf(stderr, "usage: example EXPORTED SAMPLES.CSV RATE_HZ\n");
    return 2;
  }
  predictor = strainwave_predictor_open(argv[1], error, sizeof error);
  if (predictor == NULL) {
    fprintf(stderr, "%s\n", error);
    return 2;
  }
  for (size_t k = 0; k < strainwave_predictor_channel_count(predictor); ++k) {
    fprintf(stderr, "channel %s\n", strainwave_predictor_channel_name(predictor, k));
  }
  file = fopen(argv[2], "r");
  if (file == NULL) {
    perror(argv[2]);
    strainwave_predictor_close(predictor);
    return 2;
  }
  status = predict(predictor, file, strtod(argv[3], NULL));
  fclose(file);
  strainwave_predictor_close(predictor);
  return status;
}
