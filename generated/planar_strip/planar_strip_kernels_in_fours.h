/* Included once for each width of vectors. */
static void MADE(planar_strip_kernels_increments_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2;
  b0 = GIVEN(0) * GIVEN(0);
  b1 = EACH((-2.7557319223985893e-06)) + b0 * (EACH(2.505210838544172e-08) + b0 * (EACH((-1.6059043836821613e-10)) + b0 * (EACH(7.647163731819816e-13) + b0 * (EACH((-2.8114572543455206e-15)) + b0 * (EACH(8.22063524662433e-18) + EACH((-1.9572941063391263e-20)) * b0)))));
  b1 = EACH(C[0]) + b0 * (EACH((-0.008333333333333333)) + b0 * (EACH(0.0001984126984126984) + b0 * b1));
  b2 = EACH(0.0005208333333333333) + b0 * (EACH((-3.1001984126984127e-06)) + b0 * (EACH(1.076457782186949e-08) + b0 * (EACH((-2.446494959515793e-11)) + b0 * (EACH(3.920664999224027e-14) + b0 * (EACH((-4.667458332409556e-17)) + EACH(4.289943320229371e-20) * b0)))));
  b2 = EACH(1.0) + b0 * (EACH((-0.041666666666666664)) + b0 * b2);
  STORE(made + 0, (EACH(1.0) - b0 * b1) / b2);
  STORE(made + 4, b2 / EACH(2.0) * GIVEN(0));
  STORE(made + 8, GIVEN(0));
  STORE(made + 12, b2);
  STORE(made + 16, b1);
}

static void MADE(planar_strip_kernels_increments)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 4, made += 20)
    EVERY_LANE(MADE(planar_strip_kernels_increments_turn)(given + lane, made + lane))
}

static void MADE(planar_strip_k_jacobian_columns_0)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8;
  b0 = w[42] * TURN(0);
  b1 = b0 + w[51] * TURN(4);
  b2 = b1 + w[60] * TURN(8);
  b3 = b2 + w[69] * TURN(12);
  b4 = b3 + w[78] * TURN(16);
  b5 = w[144] * (b4 + w[87] * TURN(20));
  b4 = b5 + w[145] * b4;
  b3 = b4 + w[146] * b3;
  b2 = b3 + w[147] * b2;
  b1 = b2 + w[148] * b1;
  b0 = w[42] * (b1 + w[149] * b0);
  b5 = w[87] * b5;
  b6 = b0 + b5;
  b1 = w[51] * b1;
  b4 = w[78] * b4;
  b7 = b1 + b4;
  b2 = w[60] * b2;
  b3 = w[69] * b3;
  b8 = b2 + b3;
  b5 = b0 - b5;
  b4 = b1 - b4;
  b3 = b2 - b3;
  STORE(columns + 0, EACH(C[1]) * (EACH(C[2]) * b6 + EACH(C[3]) * b7 + EACH(C[4]) * b8));
  STORE(columns + 4, EACH(C[1]) * (EACH(C[5]) * b5 + EACH(C[6]) * b4 + EACH(C[5]) * b3));
  STORE(columns + 8, EACH(C[1]) * (EACH(C[7]) * b6 + EACH(C[8]) * b7 + EACH(C[9]) * b8));
  STORE(columns + 12, EACH(C[1]) * (EACH(C[10]) * b5 + EACH(C[11]) * b4 + EACH(C[12]) * b3));
}

static void MADE(planar_strip_k_jacobian_columns)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed, int groups) {
  int group;
  for (group = 0; group < groups; group++, turns += 24, columns += 4) {
    EVERY_LANE(MADE(planar_strip_k_jacobian_columns_0)(w, turns + lane, columns + lane, passed + lane))
  }
}

static void MADE(planar_strip_k_tip_jacobian_columns_0)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6;
  b0 = w[42] * TURN(0);
  b1 = b0 + w[42] * TURN(4);
  b2 = b1 + w[42] * TURN(8);
  b3 = b2 + w[42] * TURN(12);
  b4 = b3 + w[42] * TURN(16);
  b5 = b4 + w[42] * TURN(20);
  b6 = w[52] * b0 + w[53] * b1 + w[54] * b2 + w[55] * b3 + w[56] * b4 + w[57] * b5;
  b4 = w[58] * b0 + w[59] * b1 + w[60] * b2 + w[61] * b3 + w[62] * b4 + w[63] * b5;
  b3 = b5 * w[64] / EACH(2.0);
  b5 = b5 * w[65] / EACH(2.0);
  STORE(columns + 0, EACH(C[13]) * b6 - b4);
  FILL(columns + 4, 0);
  STORE(columns + 8, EACH((-1.0)) * (b6 + EACH(C[13]) * b4));
  STORE(columns + 12, EACH((-1.0)) * (EACH(C[14]) * b3 + EACH(C[15]) * b5));
  FILL(columns + 16, 0);
  STORE(columns + 20, EACH(C[14]) * b5 - EACH(C[15]) * b3);
  FILL(columns + 24, 0);
}

static void MADE(planar_strip_k_tip_jacobian_columns)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed, int groups) {
  int group;
  for (group = 0; group < groups; group++, turns += 24, columns += 4) {
    EVERY_LANE(MADE(planar_strip_k_tip_jacobian_columns_0)(w, turns + lane, columns + lane, passed + lane))
  }
}
