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

static void MADE(planar_strip_kernels_pulls_turn)(const casadi_real *given, casadi_real *made) {
  STORE(made + 0, GIVEN(24) * GIVEN(40));
}

static void MADE(planar_strip_kernels_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 48, made += 4)
    EVERY_LANE(MADE(planar_strip_kernels_pulls_turn)(given + lane, made + lane))
}

static void MADE(planar_strip_kernels_variations_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6;
  b0 = GIVEN(24) * GIVEN(4);
  b1 = EACH(0.5) / (GIVEN(8) * GIVEN(8));
  b2 = b0 * b0;
  b3 = EACH((-1.6534391534391535e-06)) + b2 * (EACH(1.670140559029448e-08) + b2 * (EACH((-1.1470745597729724e-10)) + b2 * (EACH(5.735372798864862e-13) + b2 * (EACH((-2.186688975602072e-15)) + b2 * (EACH(6.576508197299464e-18) + EACH((-1.6014224506411032e-20)) * b2)))));
  b3 = EACH((-0.002777777777777778)) + b2 * (EACH(9.92063492063492e-05) + b2 * b3);
  b2 = b1 * (GIVEN(12) + b2 * b3);
  b3 = EACH((-1.0)) * (EACH(2.0) * (b0 * (b1 * b3 * (GIVEN(40) * b0) * b0 - b2 * GIVEN(40))));
  b1 = GIVEN(44) / EACH(2.0);
  b4 = b0 * (b2 * GIVEN(36));
  b5 = GIVEN(40) / EACH(2.0);
  b6 = GIVEN(36) / EACH(2.0);
  b2 = b0 * (b2 * GIVEN(44));
  STORE(made + 0, GIVEN(24));
  STORE(made + 4, b3);
  STORE(made + 8, b1 - b4);
  STORE(made + 12, EACH((-1.0)) * b5);
  STORE(made + 16, EACH((-1.0)) * (b1 + b4));
  STORE(made + 20, b6 - b2);
  STORE(made + 24, b5);
  STORE(made + 28, EACH((-1.0)) * (b6 + b2));
  STORE(made + 32, b3);
}

static void MADE(planar_strip_kernels_variations)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 48, made += 36)
    EVERY_LANE(MADE(planar_strip_kernels_variations_turn)(given + lane, made + lane))
}

static void MADE(planar_strip_kernels_fwd1_pulls_turn)(const casadi_real *given, casadi_real *made) {
  STORE(made + 0, GIVEN(40) * GIVEN(72) + GIVEN(24) * GIVEN(88));
}

static void MADE(planar_strip_kernels_fwd1_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 96, made += 4)
    EVERY_LANE(MADE(planar_strip_kernels_fwd1_pulls_turn)(given + lane, made + lane))
}

static void MADE(planar_strip_kernels_turnings_turn)(const casadi_real *given, casadi_real *made) {
  STORE(made + 0, GIVEN(24));
}

static void MADE(planar_strip_kernels_turnings)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 36, made += 4)
    EVERY_LANE(MADE(planar_strip_kernels_turnings_turn)(given + lane, made + lane))
}

static void MADE(planar_strip_k_jacobian_columns_0)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8;
  b0 = w[40] * TURN(0);
  b1 = b0 + w[41] * TURN(4);
  b2 = b1 + w[42] * TURN(8);
  b3 = b2 + w[43] * TURN(12);
  b4 = b3 + w[76] * TURN(16);
  b5 = w[214] * (b4 + w[77] * TURN(20));
  b4 = b5 + w[215] * b4;
  b3 = b4 + w[216] * b3;
  b2 = b3 + w[217] * b2;
  b1 = b2 + w[218] * b1;
  b0 = w[40] * (b1 + w[219] * b0);
  b5 = w[77] * b5;
  b6 = b0 + b5;
  b1 = w[41] * b1;
  b4 = w[76] * b4;
  b7 = b1 + b4;
  b2 = w[42] * b2;
  b3 = w[43] * b3;
  b8 = b2 + b3;
  b5 = b0 - b5;
  b4 = b1 - b4;
  b3 = b2 - b3;
  STORE(columns + 0, EACH(C[1]) * b6 + EACH(C[2]) * b7 + EACH(C[3]) * b8);
  STORE(columns + 4, EACH(C[4]) * b5 + EACH(C[5]) * b4 + EACH(C[4]) * b3);
  STORE(columns + 8, EACH(C[6]) * b6 + EACH(C[7]) * b7 + EACH(1.5625) * b8);
  STORE(columns + 12, EACH(C[8]) * b5 + EACH(C[9]) * b4 + EACH(C[10]) * b3);
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
  b0 = w[40] * TURN(0);
  b1 = b0 + w[41] * TURN(4);
  b2 = b1 + w[42] * TURN(8);
  b3 = b2 + w[43] * TURN(12);
  b4 = b3 + w[44] * TURN(16);
  b5 = b4 + w[45] * TURN(20);
  b6 = w[121] * b0 + w[123] * b1 + w[125] * b2 + w[127] * b3 + w[129] * b4 + w[131] * b5;
  b4 = w[132] * b0 + w[133] * b1 + w[134] * b2 + w[135] * b3 + w[136] * b4 + w[137] * b5;
  b3 = b5 * w[138] / EACH(2.0);
  b5 = b5 * w[139] / EACH(2.0);
  STORE(columns + 0, EACH(C[11]) * b6 - b4);
  FILL(columns + 4, 0);
  STORE(columns + 8, EACH((-1.0)) * (b6 + EACH(C[11]) * b4));
  STORE(columns + 12, EACH((-1.0)) * (EACH(C[12]) * b3 + EACH(C[13]) * b5));
  FILL(columns + 16, 0);
  STORE(columns + 20, EACH(C[12]) * b5 - EACH(C[13]) * b3);
  FILL(columns + 24, 0);
}

static void MADE(planar_strip_k_tip_jacobian_columns)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed, int groups) {
  int group;
  for (group = 0; group < groups; group++, turns += 24, columns += 4) {
    EVERY_LANE(MADE(planar_strip_k_tip_jacobian_columns_0)(w, turns + lane, columns + lane, passed + lane))
  }
}
