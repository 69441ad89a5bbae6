/* Included once for each width of vectors. */
static void MADE(nitinol_wire_derivatives_increments_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6;
  b0 = LOAD(given + 0) + (LOAD(given + 4) * LOAD(given + 20) - LOAD(given + 8) * LOAD(given + 16)) / EACH(12.0);
  b1 = LOAD(given + 4) + (LOAD(given + 8) * LOAD(given + 12) - LOAD(given + 0) * LOAD(given + 20)) / EACH(12.0);
  b2 = LOAD(given + 8) + (LOAD(given + 0) * LOAD(given + 16) - LOAD(given + 4) * LOAD(given + 12)) / EACH(12.0);
  b3 = b0 * b0 + b1 * b1 + b2 * b2;
  b4 = EACH((-2.8114572543455206e-15)) + b3 * (EACH(8.22063524662433e-18) + EACH((-1.9572941063391263e-20)) * b3);
  b4 = b3 * (EACH((-1.6059043836821613e-10)) + b3 * (EACH(7.647163731819816e-13) + b3 * b4));
  b4 = b3 * (EACH((-2.7557319223985893e-06)) + b3 * (EACH(2.505210838544172e-08) + b4));
  b4 = EACH(0.16666666666666666) + b3 * (EACH((-0.008333333333333333)) + b3 * (EACH(0.0001984126984126984) + b4));
  b5 = EACH(3.920664999224027e-14) + b3 * (EACH((-4.667458332409556e-17)) + EACH(4.289943320229371e-20) * b3);
  b5 = b3 * (EACH(1.076457782186949e-08) + b3 * (EACH((-2.446494959515793e-11)) + b3 * b5));
  b5 = b3 * (EACH(0.0005208333333333333) + b3 * (EACH((-3.1001984126984127e-06)) + b5));
  b5 = EACH(1.0) + b3 * (EACH((-0.041666666666666664)) + b5);
  b6 = b5 / EACH(2.0);
  STORE(made + 0, (EACH(1.0) - b3 * b4) / b5);
  STORE(made + 4, b6 * b0);
  STORE(made + 8, b6 * b1);
  STORE(made + 12, b6 * b2);
  STORE(made + 16, b0);
  STORE(made + 20, b1);
  STORE(made + 24, b2);
  STORE(made + 28, b5);
  STORE(made + 32, b4);
}

static void MADE(nitinol_wire_derivatives_increments)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 24, made += 36)
    EVERY_LANE(MADE(nitinol_wire_derivatives_increments_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_derivatives_pulls_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7;
  b0 = LOAD(given + 76) * LOAD(given + 88);
  b0 = LOAD(given + 68) * LOAD(given + 80) + LOAD(given + 72) * LOAD(given + 84) + b0;
  b1 = LOAD(given + 52) * LOAD(given + 88);
  b1 = LOAD(given + 44) * LOAD(given + 80) + LOAD(given + 48) * LOAD(given + 84) + b1;
  b2 = LOAD(given + 36) * LOAD(given + 36) / EACH(2.0);
  b3 = LOAD(given + 64) * LOAD(given + 88);
  b3 = LOAD(given + 56) * LOAD(given + 80) + LOAD(given + 60) * LOAD(given + 84) + b3;
  b4 = LOAD(given + 40) * (LOAD(given + 32) * b1 - LOAD(given + 24) * b0) - b2 * b3;
  b5 = LOAD(given + 40) * (LOAD(given + 28) * b0 - LOAD(given + 32) * b3) - b2 * b1;
  b6 = b0 + (LOAD(given + 24) * b4 - LOAD(given + 28) * b5);
  b7 = EACH(0.08333333333333333) * b6;
  b0 = LOAD(given + 40) * (LOAD(given + 24) * b3 - LOAD(given + 28) * b1) - b2 * b0;
  b5 = b3 + (LOAD(given + 32) * b5 - LOAD(given + 24) * b0);
  b3 = EACH(0.08333333333333333) * b5;
  b4 = b1 + (LOAD(given + 28) * b0 - LOAD(given + 32) * b4);
  b0 = EACH(0.08333333333333333) * b4;
  STORE(made + 0, LOAD(given + 16) * b7 - LOAD(given + 20) * b3 + b4);
  STORE(made + 4, b5 - LOAD(given + 12) * b7 + LOAD(given + 20) * b0);
  STORE(made + 8, b6 + LOAD(given + 12) * b3 - LOAD(given + 16) * b0);
  STORE(made + 12, LOAD(given + 8) * b3 - LOAD(given + 4) * b7);
  STORE(made + 16, LOAD(given + 0) * b7 - LOAD(given + 8) * b0);
  STORE(made + 20, LOAD(given + 4) * b0 - LOAD(given + 0) * b3);
}

static void MADE(nitinol_wire_derivatives_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 92, made += 24)
    EVERY_LANE(MADE(nitinol_wire_derivatives_pulls_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_derivatives_fwd1_increments_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17;
  b0 = LOAD(given + 0) + (LOAD(given + 4) * LOAD(given + 20) - LOAD(given + 8) * LOAD(given + 16)) / EACH(12.0);
  b1 = LOAD(given + 4) + (LOAD(given + 8) * LOAD(given + 12) - LOAD(given + 0) * LOAD(given + 20)) / EACH(12.0);
  b2 = LOAD(given + 8) + (LOAD(given + 0) * LOAD(given + 16) - LOAD(given + 4) * LOAD(given + 12)) / EACH(12.0);
  b3 = b0 * b0 + b1 * b1 + b2 * b2;
  b4 = EACH(8.22063524662433e-18) + EACH((-1.9572941063391263e-20)) * b3;
  b5 = EACH((-2.8114572543455206e-15)) + b3 * b4;
  b6 = EACH(7.647163731819816e-13) + b3 * b5;
  b7 = EACH((-1.6059043836821613e-10)) + b3 * b6;
  b8 = EACH(2.505210838544172e-08) + b3 * b7;
  b9 = EACH((-2.7557319223985893e-06)) + b3 * b8;
  b10 = EACH(0.0001984126984126984) + b3 * b9;
  b11 = EACH((-0.008333333333333333)) + b3 * b10;
  b12 = EACH(0.16666666666666666) + b3 * b11;
  b13 = LOAD(given + 16) * LOAD(given + 32) + LOAD(given + 8) * LOAD(given + 40);
  b13 = EACH(0.08333333333333333) * (LOAD(given + 20) * LOAD(given + 28) + LOAD(given + 4) * LOAD(given + 44) - b13);
  b13 = LOAD(given + 24) + b13;
  b14 = LOAD(given + 20) * LOAD(given + 24) + LOAD(given + 0) * LOAD(given + 44);
  b14 = EACH(0.08333333333333333) * (LOAD(given + 12) * LOAD(given + 32) + LOAD(given + 8) * LOAD(given + 36) - b14);
  b14 = LOAD(given + 28) + b14;
  b15 = LOAD(given + 12) * LOAD(given + 28) + LOAD(given + 4) * LOAD(given + 36);
  b15 = EACH(0.08333333333333333) * (LOAD(given + 16) * LOAD(given + 24) + LOAD(given + 0) * LOAD(given + 40) - b15);
  b15 = LOAD(given + 32) + b15;
  b16 = EACH(2.0) * b0 * b13 + EACH(2.0) * b1 * b14 + EACH(2.0) * b2 * b15;
  b4 = b3 * (b6 * b16 + b3 * (b5 * b16 + b3 * (b4 * b16 + b3 * (EACH((-1.9572941063391263e-20)) * b16))));
  b4 = b11 * b16 + b3 * (b10 * b16 + b3 * (b9 * b16 + b3 * (b8 * b16 + b3 * (b7 * b16 + b4))));
  b7 = EACH((-4.667458332409556e-17)) + EACH(4.289943320229371e-20) * b3;
  b8 = EACH(3.920664999224027e-14) + b3 * b7;
  b9 = EACH((-2.446494959515793e-11)) + b3 * b8;
  b10 = EACH(1.076457782186949e-08) + b3 * b9;
  b11 = EACH((-3.1001984126984127e-06)) + b3 * b10;
  b5 = EACH(0.0005208333333333333) + b3 * b11;
  b6 = EACH((-0.041666666666666664)) + b3 * b5;
  b17 = EACH(1.0) + b3 * b6;
  b7 = b3 * (b9 * b16 + b3 * (b8 * b16 + b3 * (b7 * b16 + b3 * (EACH(4.289943320229371e-20) * b16))));
  b7 = b6 * b16 + b3 * (b5 * b16 + b3 * (b11 * b16 + b3 * (b10 * b16 + b7)));
  b10 = EACH(0.5) * b7;
  b11 = b17 / EACH(2.0);
  STORE(made + 0, EACH((-1.0)) * ((b12 * b16 + b3 * b4) / b17 + (EACH(1.0) - b3 * b12) / b17 / b17 * b7));
  STORE(made + 4, b0 * b10 + b11 * b13);
  STORE(made + 8, b1 * b10 + b11 * b14);
  STORE(made + 12, b2 * b10 + b11 * b15);
  STORE(made + 16, b13);
  STORE(made + 20, b14);
  STORE(made + 24, b15);
  STORE(made + 28, b7);
  STORE(made + 32, b4);
}

static void MADE(nitinol_wire_derivatives_fwd1_increments)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 48, made += 36)
    EVERY_LANE(MADE(nitinol_wire_derivatives_fwd1_increments_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_derivatives_fwd1_pulls_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17;
  b0 = LOAD(given + 76) * LOAD(given + 88);
  b0 = LOAD(given + 68) * LOAD(given + 80) + LOAD(given + 72) * LOAD(given + 84) + b0;
  b1 = LOAD(given + 52) * LOAD(given + 88);
  b1 = LOAD(given + 44) * LOAD(given + 80) + LOAD(given + 48) * LOAD(given + 84) + b1;
  b2 = LOAD(given + 32) * b1 - LOAD(given + 24) * b0;
  b3 = LOAD(given + 36) * LOAD(given + 36) / EACH(2.0);
  b4 = LOAD(given + 64) * LOAD(given + 88);
  b4 = LOAD(given + 56) * LOAD(given + 80) + LOAD(given + 60) * LOAD(given + 84) + b4;
  b5 = LOAD(given + 40) * b2 - b3 * b4;
  b6 = LOAD(given + 28) * b0 - LOAD(given + 32) * b4;
  b7 = LOAD(given + 40) * b6 - b3 * b1;
  b8 = EACH(0.08333333333333333) * (b0 + (LOAD(given + 24) * b5 - LOAD(given + 28) * b7));
  b9 = LOAD(given + 84) * LOAD(given + 164) + LOAD(given + 72) * LOAD(given + 176);
  b10 = LOAD(given + 88) * LOAD(given + 168) + LOAD(given + 76) * LOAD(given + 180);
  b10 = LOAD(given + 80) * LOAD(given + 160) + LOAD(given + 68) * LOAD(given + 172) + b9 + b10;
  b9 = LOAD(given + 84) * LOAD(given + 140) + LOAD(given + 48) * LOAD(given + 176);
  b11 = LOAD(given + 88) * LOAD(given + 144) + LOAD(given + 52) * LOAD(given + 180);
  b11 = LOAD(given + 80) * LOAD(given + 136) + LOAD(given + 44) * LOAD(given + 172) + b9 + b11;
  b9 = b1 * LOAD(given + 124) + LOAD(given + 32) * b11 - (b0 * LOAD(given + 116) + LOAD(given + 24) * b10);
  b12 = EACH(0.5) * (EACH(2.0) * LOAD(given + 36) * LOAD(given + 128));
  b13 = LOAD(given + 84) * LOAD(given + 152) + LOAD(given + 60) * LOAD(given + 176);
  b14 = LOAD(given + 88) * LOAD(given + 156) + LOAD(given + 64) * LOAD(given + 180);
  b14 = LOAD(given + 80) * LOAD(given + 148) + LOAD(given + 56) * LOAD(given + 172) + b13 + b14;
  b9 = b2 * LOAD(given + 132) + LOAD(given + 40) * b9 - (b4 * b12 + b3 * b14);
  b2 = b0 * LOAD(given + 120) + LOAD(given + 28) * b10 - (b4 * LOAD(given + 124) + LOAD(given + 32) * b14);
  b2 = b6 * LOAD(given + 132) + LOAD(given + 40) * b2 - (b1 * b12 + b3 * b11);
  b6 = b10 + (b5 * LOAD(given + 116) + LOAD(given + 24) * b9 - (b7 * LOAD(given + 120) + LOAD(given + 28) * b2));
  b13 = EACH(0.08333333333333333) * b6;
  b15 = LOAD(given + 24) * b4 - LOAD(given + 28) * b1;
  b16 = LOAD(given + 40) * b15 - b3 * b0;
  b17 = EACH(0.08333333333333333) * (b4 + (LOAD(given + 32) * b7 - LOAD(given + 24) * b16));
  b4 = b4 * LOAD(given + 116) + LOAD(given + 24) * b14 - (b1 * LOAD(given + 120) + LOAD(given + 28) * b11);
  b10 = b15 * LOAD(given + 132) + LOAD(given + 40) * b4 - (b0 * b12 + b3 * b10);
  b2 = b14 + (b7 * LOAD(given + 124) + LOAD(given + 32) * b2 - (b16 * LOAD(given + 116) + LOAD(given + 24) * b10));
  b7 = EACH(0.08333333333333333) * b2;
  b9 = b11 + (b16 * LOAD(given + 120) + LOAD(given + 28) * b10 - (b5 * LOAD(given + 124) + LOAD(given + 32) * b9));
  b5 = EACH(0.08333333333333333) * (b1 + (LOAD(given + 28) * b16 - LOAD(given + 32) * b5));
  b16 = EACH(0.08333333333333333) * b9;
  b9 = b8 * LOAD(given + 108) + LOAD(given + 16) * b13 - (b17 * LOAD(given + 112) + LOAD(given + 20) * b7) + b9;
  STORE(made + 0, b9);
  b2 = b2 - (b8 * LOAD(given + 104) + LOAD(given + 12) * b13) + (b5 * LOAD(given + 112) + LOAD(given + 20) * b16);
  STORE(made + 4, b2);
  b6 = b6 + (b17 * LOAD(given + 104) + LOAD(given + 12) * b7) - (b5 * LOAD(given + 108) + LOAD(given + 16) * b16);
  STORE(made + 8, b6);
  b6 = b17 * LOAD(given + 100) + LOAD(given + 8) * b7 - (b8 * LOAD(given + 96) + LOAD(given + 4) * b13);
  STORE(made + 12, b6);
  b13 = b8 * LOAD(given + 92) + LOAD(given + 0) * b13 - (b5 * LOAD(given + 100) + LOAD(given + 8) * b16);
  STORE(made + 16, b13);
  b7 = b5 * LOAD(given + 96) + LOAD(given + 4) * b16 - (b17 * LOAD(given + 92) + LOAD(given + 0) * b7);
  STORE(made + 20, b7);
}

static void MADE(nitinol_wire_derivatives_fwd1_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 184, made += 24)
    EVERY_LANE(MADE(nitinol_wire_derivatives_fwd1_pulls_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_derivatives_adj1_pulls_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20, b21, b22, b23;
  b0 = LOAD(given + 76) * LOAD(given + 88);
  b0 = LOAD(given + 68) * LOAD(given + 80) + LOAD(given + 72) * LOAD(given + 84) + b0;
  b1 = LOAD(given + 52) * LOAD(given + 88);
  b1 = LOAD(given + 44) * LOAD(given + 80) + LOAD(given + 48) * LOAD(given + 84) + b1;
  b2 = LOAD(given + 32) * b1 - LOAD(given + 24) * b0;
  b3 = LOAD(given + 36) * LOAD(given + 36) / EACH(2.0);
  b4 = LOAD(given + 64) * LOAD(given + 88);
  b4 = LOAD(given + 56) * LOAD(given + 80) + LOAD(given + 60) * LOAD(given + 84) + b4;
  b5 = LOAD(given + 40) * b2 - b3 * b4;
  b6 = LOAD(given + 28) * b0 - LOAD(given + 32) * b4;
  b7 = LOAD(given + 40) * b6 - b3 * b1;
  b8 = EACH(0.08333333333333333) * (b0 + (LOAD(given + 24) * b5 - LOAD(given + 28) * b7));
  b9 = LOAD(given + 24) * b4 - LOAD(given + 28) * b1;
  b10 = LOAD(given + 40) * b9 - b3 * b0;
  b11 = EACH(0.08333333333333333) * (b4 + (LOAD(given + 32) * b7 - LOAD(given + 24) * b10));
  b12 = EACH(0.08333333333333333) * (b1 + (LOAD(given + 28) * b10 - LOAD(given + 32) * b5));
  b13 = LOAD(given + 16) * LOAD(given + 100);
  b14 = LOAD(given + 20) * LOAD(given + 96);
  b14 = LOAD(given + 4) * LOAD(given + 112) - LOAD(given + 8) * LOAD(given + 108) - b13 + b14;
  b14 = EACH(0.08333333333333333) * b14 + LOAD(given + 92);
  b13 = LOAD(given + 12) * LOAD(given + 100);
  b15 = LOAD(given + 20) * LOAD(given + 92);
  b15 = LOAD(given + 8) * LOAD(given + 104) - LOAD(given + 0) * LOAD(given + 112) + b13 - b15;
  b15 = LOAD(given + 96) + EACH(0.08333333333333333) * b15;
  b13 = LOAD(given + 28) * b14 - LOAD(given + 24) * b15;
  b16 = LOAD(given + 40) * b13;
  b17 = LOAD(given + 12) * LOAD(given + 96);
  b18 = LOAD(given + 16) * LOAD(given + 92);
  b18 = LOAD(given + 0) * LOAD(given + 108) - LOAD(given + 4) * LOAD(given + 104) - b17 + b18;
  b18 = LOAD(given + 100) + EACH(0.08333333333333333) * b18;
  b17 = LOAD(given + 24) * b18 - LOAD(given + 32) * b14;
  b19 = LOAD(given + 40) * b17;
  b20 = LOAD(given + 32) * b15 - LOAD(given + 28) * b18;
  b21 = LOAD(given + 40) * b20;
  b22 = b14 - LOAD(given + 28) * b16 - b3 * b20 + LOAD(given + 32) * b19;
  b23 = b15 + LOAD(given + 24) * b16 - LOAD(given + 32) * b21 - b3 * b17;
  b3 = b18 - b3 * b13 + LOAD(given + 28) * b21 - LOAD(given + 24) * b19;
  STORE(made + 0, b8 * LOAD(given + 108) - b11 * LOAD(given + 112));
  STORE(made + 4, b12 * LOAD(given + 112) - b8 * LOAD(given + 104));
  STORE(made + 8, b11 * LOAD(given + 104) - b12 * LOAD(given + 108));
  STORE(made + 12, b11 * LOAD(given + 100) - b8 * LOAD(given + 96));
  STORE(made + 16, b8 * LOAD(given + 92) - b12 * LOAD(given + 100));
  STORE(made + 20, b12 * LOAD(given + 96) - b11 * LOAD(given + 92));
  STORE(made + 24, b4 * b16 - b10 * b15 + b5 * b18 - b0 * b19);
  STORE(made + 28, b10 * b14 - b1 * b16 - b7 * b18 + b0 * b21);
  STORE(made + 32, b7 * b15 - b5 * b14 - b4 * b21 + b1 * b19);
  b4 = EACH((-1.0)) * (EACH(2.0) * LOAD(given + 36) * (EACH(0.5) * (b0 * b13 + b1 * b20 + b4 * b17)));
  STORE(made + 36, b4);
  STORE(made + 40, b9 * b13 + b6 * b20 + b2 * b17);
  STORE(made + 44, LOAD(given + 80) * b22);
  STORE(made + 48, LOAD(given + 84) * b22);
  STORE(made + 52, LOAD(given + 88) * b22);
  STORE(made + 56, LOAD(given + 80) * b23);
  STORE(made + 60, LOAD(given + 84) * b23);
  STORE(made + 64, LOAD(given + 88) * b23);
  STORE(made + 68, LOAD(given + 80) * b3);
  STORE(made + 72, LOAD(given + 84) * b3);
  STORE(made + 76, LOAD(given + 88) * b3);
  STORE(made + 80, LOAD(given + 56) * b23 + LOAD(given + 44) * b22 + LOAD(given + 68) * b3);
  STORE(made + 84, LOAD(given + 60) * b23 + LOAD(given + 48) * b22 + LOAD(given + 72) * b3);
  STORE(made + 88, LOAD(given + 64) * b23 + LOAD(given + 52) * b22 + LOAD(given + 76) * b3);
}

static void MADE(nitinol_wire_derivatives_adj1_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 116, made += 92)
    EVERY_LANE(MADE(nitinol_wire_derivatives_adj1_pulls_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_derivatives_adj1_increments_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20, b21, b22, b23, b24, b25, b26, b27, b28, b29, b30;
  b0 = LOAD(given + 0) + (LOAD(given + 4) * LOAD(given + 20) - LOAD(given + 8) * LOAD(given + 16)) / EACH(12.0);
  b1 = LOAD(given + 4) + (LOAD(given + 8) * LOAD(given + 12) - LOAD(given + 0) * LOAD(given + 20)) / EACH(12.0);
  b2 = LOAD(given + 8) + (LOAD(given + 0) * LOAD(given + 16) - LOAD(given + 4) * LOAD(given + 12)) / EACH(12.0);
  b3 = b0 * b0 + b1 * b1 + b2 * b2;
  b4 = EACH((-4.667458332409556e-17)) + EACH(4.289943320229371e-20) * b3;
  b5 = EACH(3.920664999224027e-14) + b3 * b4;
  b6 = EACH((-2.446494959515793e-11)) + b3 * b5;
  b7 = EACH(1.076457782186949e-08) + b3 * b6;
  b8 = EACH((-3.1001984126984127e-06)) + b3 * b7;
  b9 = EACH(0.0005208333333333333) + b3 * b8;
  b10 = EACH((-0.041666666666666664)) + b3 * b9;
  b11 = EACH(1.0) + b3 * b10;
  b12 = b11 / EACH(2.0);
  b13 = EACH(8.22063524662433e-18) + EACH((-1.9572941063391263e-20)) * b3;
  b14 = EACH((-2.8114572543455206e-15)) + b3 * b13;
  b15 = EACH(7.647163731819816e-13) + b3 * b14;
  b16 = EACH((-1.6059043836821613e-10)) + b3 * b15;
  b17 = EACH(2.505210838544172e-08) + b3 * b16;
  b18 = EACH((-2.7557319223985893e-06)) + b3 * b17;
  b19 = EACH(0.0001984126984126984) + b3 * b18;
  b20 = EACH((-0.008333333333333333)) + b3 * b19;
  b21 = EACH(0.16666666666666666) + b3 * b20;
  b22 = LOAD(given + 52) + EACH(0.5) * (b2 * LOAD(given + 36) + b1 * LOAD(given + 32) + b0 * LOAD(given + 28));
  b22 = b22 - (EACH(1.0) - b3 * b21) / b11 / b11 * LOAD(given + 24);
  b23 = b3 * b22;
  b24 = b3 * b23;
  b25 = b3 * b24;
  b26 = b3 * b25;
  b27 = b3 * b26;
  b28 = b3 * b27;
  b29 = EACH(4.289943320229371e-20) * (b3 * b28);
  b11 = LOAD(given + 24) / b11;
  b30 = LOAD(given + 56) - b3 * b11;
  b20 = b20 * b30;
  b30 = b3 * b30;
  b20 = b10 * b22 + b9 * b23 + b8 * b24 + b7 * b25 + b6 * b26 + b5 * b27 + b4 * b28 + b29 - b21 * b11 + b20;
  b11 = b3 * b30;
  b21 = b3 * b11;
  b29 = b3 * b21;
  b28 = b3 * b29;
  b4 = b3 * b28;
  b27 = b3 * b4;
  b3 = EACH((-1.9572941063391263e-20)) * (b3 * b27);
  b3 = b20 + b19 * b30 + b18 * b11 + b17 * b21 + b16 * b29 + b15 * b28 + b14 * b4 + b13 * b27 + b3;
  b2 = LOAD(given + 48) + b12 * LOAD(given + 36) + EACH(2.0) * b2 * b3;
  b27 = EACH(0.08333333333333333) * b2;
  b1 = LOAD(given + 44) + b12 * LOAD(given + 32) + EACH(2.0) * b1 * b3;
  b13 = EACH(0.08333333333333333) * b1;
  b3 = LOAD(given + 40) + b12 * LOAD(given + 28) + EACH(2.0) * b0 * b3;
  b0 = EACH(0.08333333333333333) * b3;
  STORE(made + 0, LOAD(given + 16) * b27 - LOAD(given + 20) * b13 + b3);
  STORE(made + 4, b1 - LOAD(given + 12) * b27 + LOAD(given + 20) * b0);
  STORE(made + 8, b2 + LOAD(given + 12) * b13 - LOAD(given + 16) * b0);
  STORE(made + 12, LOAD(given + 8) * b13 - LOAD(given + 4) * b27);
  STORE(made + 16, LOAD(given + 0) * b27 - LOAD(given + 8) * b0);
  STORE(made + 20, LOAD(given + 4) * b0 - LOAD(given + 0) * b13);
}

static void MADE(nitinol_wire_derivatives_adj1_increments)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 60, made += 24)
    EVERY_LANE(MADE(nitinol_wire_derivatives_adj1_increments_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_derivatives_fwd1_adj1_pulls_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20, b21, b22, b23, b24, b25, b26, b27, b28, b29, b30, b31;
  FOUR b32, b33, b34, b35, b36, b37, b38, b39, b40, b41, b42, b43, b44, b45, b46, b47;
  FOUR b48, b49, b50, b51, b52;
  b0 = LOAD(given + 84) * LOAD(given + 188) + LOAD(given + 72) * LOAD(given + 200);
  b1 = LOAD(given + 88) * LOAD(given + 192) + LOAD(given + 76) * LOAD(given + 204);
  b1 = LOAD(given + 80) * LOAD(given + 184) + LOAD(given + 68) * LOAD(given + 196) + b0 + b1;
  b0 = LOAD(given + 52) * LOAD(given + 88);
  b0 = LOAD(given + 44) * LOAD(given + 80) + LOAD(given + 48) * LOAD(given + 84) + b0;
  b2 = LOAD(given + 76) * LOAD(given + 88);
  b2 = LOAD(given + 68) * LOAD(given + 80) + LOAD(given + 72) * LOAD(given + 84) + b2;
  b3 = LOAD(given + 32) * b0 - LOAD(given + 24) * b2;
  b4 = LOAD(given + 36) * LOAD(given + 36) / EACH(2.0);
  b5 = LOAD(given + 64) * LOAD(given + 88);
  b5 = LOAD(given + 56) * LOAD(given + 80) + LOAD(given + 60) * LOAD(given + 84) + b5;
  b6 = LOAD(given + 40) * b3 - b4 * b5;
  b7 = LOAD(given + 84) * LOAD(given + 164) + LOAD(given + 48) * LOAD(given + 200);
  b8 = LOAD(given + 88) * LOAD(given + 168) + LOAD(given + 52) * LOAD(given + 204);
  b8 = LOAD(given + 80) * LOAD(given + 160) + LOAD(given + 44) * LOAD(given + 196) + b7 + b8;
  b7 = b0 * LOAD(given + 148) + LOAD(given + 32) * b8 - (b2 * LOAD(given + 140) + LOAD(given + 24) * b1);
  b9 = EACH(2.0) * LOAD(given + 36);
  b10 = EACH(0.5) * (b9 * LOAD(given + 152));
  b11 = LOAD(given + 84) * LOAD(given + 176) + LOAD(given + 60) * LOAD(given + 200);
  b12 = LOAD(given + 88) * LOAD(given + 180) + LOAD(given + 64) * LOAD(given + 204);
  b12 = LOAD(given + 80) * LOAD(given + 172) + LOAD(given + 56) * LOAD(given + 196) + b11 + b12;
  b11 = b3 * LOAD(given + 156) + LOAD(given + 40) * b7 - (b5 * b10 + b4 * b12);
  b13 = LOAD(given + 28) * b2 - LOAD(given + 32) * b5;
  b14 = LOAD(given + 40) * b13 - b4 * b0;
  b15 = b2 * LOAD(given + 144) + LOAD(given + 28) * b1 - (b5 * LOAD(given + 148) + LOAD(given + 32) * b12);
  b16 = b13 * LOAD(given + 156) + LOAD(given + 40) * b15 - (b0 * b10 + b4 * b8);
  b17 = b1 + (b6 * LOAD(given + 140) + LOAD(given + 24) * b11 - (b14 * LOAD(given + 144) + LOAD(given + 28) * b16));
  b17 = EACH(0.08333333333333333) * b17;
  b18 = EACH(0.08333333333333333) * (b2 + (LOAD(given + 24) * b6 - LOAD(given + 28) * b14));
  b19 = LOAD(given + 24) * b5 - LOAD(given + 28) * b0;
  b20 = LOAD(given + 40) * b19 - b4 * b2;
  b21 = b5 * LOAD(given + 140) + LOAD(given + 24) * b12 - (b0 * LOAD(given + 144) + LOAD(given + 28) * b8);
  b22 = b19 * LOAD(given + 156) + LOAD(given + 40) * b21 - (b2 * b10 + b4 * b1);
  b23 = b12 + (b14 * LOAD(given + 148) + LOAD(given + 32) * b16 - (b20 * LOAD(given + 140) + LOAD(given + 24) * b22));
  b23 = EACH(0.08333333333333333) * b23;
  b24 = EACH(0.08333333333333333) * (b5 + (LOAD(given + 32) * b14 - LOAD(given + 24) * b20));
  b25 = b8 + (b20 * LOAD(given + 144) + LOAD(given + 28) * b22 - (b6 * LOAD(given + 148) + LOAD(given + 32) * b11));
  b25 = EACH(0.08333333333333333) * b25;
  b26 = EACH(0.08333333333333333) * (b0 + (LOAD(given + 28) * b20 - LOAD(given + 32) * b6));
  b27 = LOAD(given + 16) * LOAD(given + 100);
  b28 = LOAD(given + 20) * LOAD(given + 96);
  b28 = LOAD(given + 4) * LOAD(given + 112) - LOAD(given + 8) * LOAD(given + 108) - b27 + b28;
  b28 = EACH(0.08333333333333333) * b28 + LOAD(given + 92);
  b27 = LOAD(given + 12) * LOAD(given + 100);
  b29 = LOAD(given + 20) * LOAD(given + 92);
  b29 = LOAD(given + 8) * LOAD(given + 104) - LOAD(given + 0) * LOAD(given + 112) + b27 - b29;
  b29 = LOAD(given + 96) + EACH(0.08333333333333333) * b29;
  b27 = LOAD(given + 28) * b28 - LOAD(given + 24) * b29;
  b30 = LOAD(given + 40) * b27;
  b31 = LOAD(given + 108) * LOAD(given + 124) + LOAD(given + 8) * LOAD(given + 224);
  b32 = LOAD(given + 100) * LOAD(given + 132) + LOAD(given + 16) * LOAD(given + 216);
  b33 = LOAD(given + 96) * LOAD(given + 136) + LOAD(given + 20) * LOAD(given + 212);
  b33 = LOAD(given + 112) * LOAD(given + 120) + LOAD(given + 4) * LOAD(given + 228) - b31 - b32 + b33;
  b33 = EACH(0.08333333333333333) * b33 + LOAD(given + 208);
  b32 = LOAD(given + 112) * LOAD(given + 116) + LOAD(given + 0) * LOAD(given + 228);
  b31 = LOAD(given + 100) * LOAD(given + 128) + LOAD(given + 12) * LOAD(given + 216);
  b34 = LOAD(given + 92) * LOAD(given + 136) + LOAD(given + 20) * LOAD(given + 208);
  b34 = LOAD(given + 104) * LOAD(given + 124) + LOAD(given + 8) * LOAD(given + 220) - b32 + b31 - b34;
  b34 = LOAD(given + 212) + EACH(0.08333333333333333) * b34;
  b31 = b28 * LOAD(given + 144) + LOAD(given + 28) * b33 - (b29 * LOAD(given + 140) + LOAD(given + 24) * b34);
  b32 = b27 * LOAD(given + 156) + LOAD(given + 40) * b31;
  b35 = LOAD(given + 12) * LOAD(given + 96);
  b36 = LOAD(given + 16) * LOAD(given + 92);
  b36 = LOAD(given + 0) * LOAD(given + 108) - LOAD(given + 4) * LOAD(given + 104) - b35 + b36;
  b36 = LOAD(given + 100) + EACH(0.08333333333333333) * b36;
  b35 = LOAD(given + 104) * LOAD(given + 120) + LOAD(given + 4) * LOAD(given + 220);
  b37 = LOAD(given + 96) * LOAD(given + 128) + LOAD(given + 12) * LOAD(given + 212);
  b38 = LOAD(given + 92) * LOAD(given + 132) + LOAD(given + 16) * LOAD(given + 208);
  b38 = LOAD(given + 108) * LOAD(given + 116) + LOAD(given + 0) * LOAD(given + 224) - b35 - b37 + b38;
  b38 = LOAD(given + 216) + EACH(0.08333333333333333) * b38;
  b37 = LOAD(given + 24) * b36 - LOAD(given + 32) * b28;
  b35 = LOAD(given + 40) * b37;
  b39 = b36 * LOAD(given + 140) + LOAD(given + 24) * b38 - (b28 * LOAD(given + 148) + LOAD(given + 32) * b33);
  b40 = b37 * LOAD(given + 156) + LOAD(given + 40) * b39;
  b41 = LOAD(given + 32) * b29 - LOAD(given + 28) * b36;
  b42 = LOAD(given + 40) * b41;
  b43 = b29 * LOAD(given + 148) + LOAD(given + 32) * b34 - (b36 * LOAD(given + 144) + LOAD(given + 28) * b38);
  b44 = b41 * LOAD(given + 156) + LOAD(given + 40) * b43;
  b9 = b9 * (EACH(0.5) * (b27 * b1 + b2 * b31 + (b41 * b8 + b0 * b43) + (b37 * b12 + b5 * b39)));
  b45 = b28 - LOAD(given + 28) * b30 - b4 * b41 + LOAD(given + 32) * b35;
  b46 = b35 * LOAD(given + 148) + LOAD(given + 32) * b40;
  b46 = b33 - (b30 * LOAD(given + 144) + LOAD(given + 28) * b32) - (b41 * b10 + b4 * b43) + b46;
  b47 = b29 + LOAD(given + 24) * b30 - LOAD(given + 32) * b42 - b4 * b37;
  b48 = b34 + (b30 * LOAD(given + 140) + LOAD(given + 24) * b32) - (b42 * LOAD(given + 148) + LOAD(given + 32) * b44);
  b48 = b48 - (b37 * b10 + b4 * b39);
  b49 = b36 - b4 * b27 + LOAD(given + 28) * b42 - LOAD(given + 24) * b35;
  b50 = b35 * LOAD(given + 140) + LOAD(given + 24) * b40;
  b50 = b38 - (b27 * b10 + b4 * b31) + (b42 * LOAD(given + 144) + LOAD(given + 28) * b44) - b50;
  b4 = b49 * LOAD(given + 184) + LOAD(given + 68) * b50;
  b10 = b49 * LOAD(given + 188) + LOAD(given + 72) * b50;
  b51 = b49 * LOAD(given + 192) + LOAD(given + 76) * b50;
  b52 = LOAD(given + 108) * b17 + b18 * LOAD(given + 224) - (LOAD(given + 112) * b23 + b24 * LOAD(given + 228));
  STORE(made + 0, b52);
  b52 = LOAD(given + 112) * b25 + b26 * LOAD(given + 228) - (LOAD(given + 104) * b17 + b18 * LOAD(given + 220));
  STORE(made + 4, b52);
  b52 = LOAD(given + 104) * b23 + b24 * LOAD(given + 220) - (LOAD(given + 108) * b25 + b26 * LOAD(given + 224));
  STORE(made + 8, b52);
  b52 = LOAD(given + 100) * b23 + b24 * LOAD(given + 216) - (LOAD(given + 96) * b17 + b18 * LOAD(given + 212));
  STORE(made + 12, b52);
  b18 = LOAD(given + 92) * b17 + b18 * LOAD(given + 208) - (LOAD(given + 100) * b25 + b26 * LOAD(given + 216));
  STORE(made + 16, b18);
  b24 = LOAD(given + 96) * b25 + b26 * LOAD(given + 212) - (LOAD(given + 92) * b23 + b24 * LOAD(given + 208));
  STORE(made + 20, b24);
  b24 = b30 * b12 + b5 * b32 - (b29 * b22 + b20 * b34) + (b36 * b11 + b6 * b38) - (b35 * b1 + b2 * b40);
  STORE(made + 24, b24);
  b1 = b28 * b22 + b20 * b33 - (b30 * b8 + b0 * b32) - (b36 * b16 + b14 * b38) + (b42 * b1 + b2 * b44);
  STORE(made + 28, b1);
  b40 = b29 * b16 + b14 * b34 - (b28 * b11 + b6 * b33) - (b42 * b12 + b5 * b44) + (b35 * b8 + b0 * b40);
  STORE(made + 32, b40);
  b9 = EACH((-1.0)) * (EACH(0.5) * (b2 * b27 + b0 * b41 + b5 * b37) * (EACH(2.0) * LOAD(given + 152)) + b9);
  STORE(made + 36, b9);
  STORE(made + 40, b27 * b21 + b19 * b31 + (b41 * b15 + b13 * b43) + (b37 * b7 + b3 * b39));
  STORE(made + 44, b45 * LOAD(given + 196) + LOAD(given + 80) * b46);
  STORE(made + 48, b45 * LOAD(given + 200) + LOAD(given + 84) * b46);
  STORE(made + 52, b45 * LOAD(given + 204) + LOAD(given + 88) * b46);
  STORE(made + 56, b47 * LOAD(given + 196) + LOAD(given + 80) * b48);
  STORE(made + 60, b47 * LOAD(given + 200) + LOAD(given + 84) * b48);
  STORE(made + 64, b47 * LOAD(given + 204) + LOAD(given + 88) * b48);
  STORE(made + 68, b49 * LOAD(given + 196) + LOAD(given + 80) * b50);
  STORE(made + 72, b49 * LOAD(given + 200) + LOAD(given + 84) * b50);
  STORE(made + 76, b49 * LOAD(given + 204) + LOAD(given + 88) * b50);
  b4 = b47 * LOAD(given + 172) + LOAD(given + 56) * b48 + (b45 * LOAD(given + 160) + LOAD(given + 44) * b46) + b4;
  STORE(made + 80, b4);
  b10 = b47 * LOAD(given + 176) + LOAD(given + 60) * b48 + (b45 * LOAD(given + 164) + LOAD(given + 48) * b46) + b10;
  STORE(made + 84, b10);
  b51 = b47 * LOAD(given + 180) + LOAD(given + 64) * b48 + (b45 * LOAD(given + 168) + LOAD(given + 52) * b46) + b51;
  STORE(made + 88, b51);
}

static void MADE(nitinol_wire_derivatives_fwd1_adj1_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 232, made += 92)
    EVERY_LANE(MADE(nitinol_wire_derivatives_fwd1_adj1_pulls_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_derivatives_fwd1_adj1_increments_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20, b21, b22, b23, b24, b25, b26, b27, b28, b29, b30, b31;
  FOUR b32, b33, b34, b35, b36, b37, b38, b39, b40, b41, b42, b43, b44, b45, b46, b47;
  FOUR b48, b49, b50, b51, b52, b53, b54, b55, b56, b57, b58, b59, b60, b61, b62, b63;
  FOUR b64, b65, b66;
  b0 = LOAD(given + 0) + (LOAD(given + 4) * LOAD(given + 20) - LOAD(given + 8) * LOAD(given + 16)) / EACH(12.0);
  b1 = LOAD(given + 4) + (LOAD(given + 8) * LOAD(given + 12) - LOAD(given + 0) * LOAD(given + 20)) / EACH(12.0);
  b2 = LOAD(given + 8) + (LOAD(given + 0) * LOAD(given + 16) - LOAD(given + 4) * LOAD(given + 12)) / EACH(12.0);
  b3 = b0 * b0 + b1 * b1 + b2 * b2;
  b4 = EACH((-4.667458332409556e-17)) + EACH(4.289943320229371e-20) * b3;
  b5 = EACH(3.920664999224027e-14) + b3 * b4;
  b6 = EACH((-2.446494959515793e-11)) + b3 * b5;
  b7 = EACH(1.076457782186949e-08) + b3 * b6;
  b8 = EACH((-3.1001984126984127e-06)) + b3 * b7;
  b9 = EACH(0.0005208333333333333) + b3 * b8;
  b10 = EACH((-0.041666666666666664)) + b3 * b9;
  b11 = EACH(1.0) + b3 * b10;
  b12 = b11 / EACH(2.0);
  b13 = EACH(2.0) * b2;
  b14 = EACH(8.22063524662433e-18) + EACH((-1.9572941063391263e-20)) * b3;
  b15 = EACH((-2.8114572543455206e-15)) + b3 * b14;
  b16 = EACH(7.647163731819816e-13) + b3 * b15;
  b17 = EACH((-1.6059043836821613e-10)) + b3 * b16;
  b18 = EACH(2.505210838544172e-08) + b3 * b17;
  b19 = EACH((-2.7557319223985893e-06)) + b3 * b18;
  b20 = EACH(0.0001984126984126984) + b3 * b19;
  b21 = EACH((-0.008333333333333333)) + b3 * b20;
  b22 = EACH(0.16666666666666666) + b3 * b21;
  b23 = (EACH(1.0) - b3 * b22) / b11 / b11;
  b24 = LOAD(given + 52) + EACH(0.5) * (b2 * LOAD(given + 36) + b1 * LOAD(given + 32) + b0 * LOAD(given + 28));
  b24 = b24 - b23 * LOAD(given + 24);
  b25 = b3 * b24;
  b26 = b3 * b25;
  b27 = b3 * b26;
  b28 = b3 * b27;
  b29 = b3 * b28;
  b30 = b3 * b29;
  b31 = EACH(4.289943320229371e-20) * (b3 * b30);
  b32 = LOAD(given + 24) / b11;
  b33 = LOAD(given + 56) - b3 * b32;
  b34 = b21 * b33;
  b35 = b3 * b33;
  b34 = b10 * b24 + b9 * b25 + b8 * b26 + b7 * b27 + b6 * b28 + b5 * b29 + b4 * b30 + b31 - b22 * b32 + b34;
  b31 = b3 * b35;
  b36 = b3 * b31;
  b37 = b3 * b36;
  b38 = b3 * b37;
  b39 = b3 * b38;
  b40 = b3 * b39;
  b41 = EACH((-1.9572941063391263e-20)) * (b3 * b40);
  b41 = b34 + b20 * b35 + b19 * b31 + b18 * b36 + b17 * b37 + b16 * b38 + b15 * b39 + b14 * b40 + b41;
  b34 = EACH(0.08333333333333333) * (LOAD(given + 48) + b12 * LOAD(given + 36) + b13 * b41);
  b42 = EACH(2.0) * b0;
  b43 = LOAD(given + 16) * LOAD(given + 68) + LOAD(given + 8) * LOAD(given + 76);
  b43 = EACH(0.08333333333333333) * (LOAD(given + 20) * LOAD(given + 64) + LOAD(given + 4) * LOAD(given + 80) - b43);
  b43 = LOAD(given + 60) + b43;
  b44 = EACH(2.0) * b1;
  b45 = LOAD(given + 20) * LOAD(given + 60) + LOAD(given + 0) * LOAD(given + 80);
  b45 = EACH(0.08333333333333333) * (LOAD(given + 12) * LOAD(given + 68) + LOAD(given + 8) * LOAD(given + 72) - b45);
  b45 = LOAD(given + 64) + b45;
  b46 = LOAD(given + 12) * LOAD(given + 64) + LOAD(given + 4) * LOAD(given + 72);
  b46 = EACH(0.08333333333333333) * (LOAD(given + 16) * LOAD(given + 60) + LOAD(given + 0) * LOAD(given + 76) - b46);
  b46 = LOAD(given + 68) + b46;
  b47 = b42 * b43 + b44 * b45 + b13 * b46;
  b48 = EACH(4.289943320229371e-20) * b47;
  b49 = b4 * b47 + b3 * b48;
  b50 = b5 * b47 + b3 * b49;
  b51 = b6 * b47 + b3 * b50;
  b52 = b7 * b47 + b3 * b51;
  b53 = b8 * b47 + b3 * b52;
  b54 = b9 * b47 + b3 * b53;
  b55 = b10 * b47 + b3 * b54;
  b56 = EACH(0.5) * b55;
  b0 = LOAD(given + 28) * b43 + b0 * LOAD(given + 88);
  b0 = LOAD(given + 36) * b46 + b2 * LOAD(given + 96) + (LOAD(given + 32) * b45 + b1 * LOAD(given + 92)) + b0;
  b1 = EACH((-1.9572941063391263e-20)) * b47;
  b2 = b14 * b47 + b3 * b1;
  b57 = b15 * b47 + b3 * b2;
  b58 = b16 * b47 + b3 * b57;
  b59 = b17 * b47 + b3 * b58;
  b60 = b18 * b47 + b3 * b59;
  b61 = b19 * b47 + b3 * b60;
  b62 = b20 * b47 + b3 * b61;
  b63 = b21 * b47 + b3 * b62;
  b64 = LOAD(given + 24) * (((b22 * b47 + b3 * b63) / b11 + b23 * b55) / b11 + b23 / b11 * b55);
  b64 = LOAD(given + 112) + EACH(0.5) * b0 - (b23 * LOAD(given + 84) - b64);
  b23 = b24 * b47 + b3 * b64;
  b0 = b25 * b47 + b3 * b23;
  b65 = b26 * b47 + b3 * b0;
  b66 = b27 * b47 + b3 * b65;
  b6 = b28 * b50 + b6 * b66;
  b66 = b28 * b47 + b3 * b66;
  b6 = b24 * b54 + b10 * b64 + (b25 * b53 + b9 * b23) + (b26 * b52 + b8 * b0) + (b27 * b51 + b7 * b65) + b6;
  b65 = b29 * b47 + b3 * b66;
  b7 = EACH(4.289943320229371e-20) * (b30 * b47 + b3 * b65);
  b55 = LOAD(given + 84) / b11 - b32 / b11 * b55;
  b11 = LOAD(given + 116) - (b32 * b47 + b3 * b55);
  b21 = b33 * b62 + b21 * b11;
  b11 = b33 * b47 + b3 * b11;
  b20 = b35 * b61 + b20 * b11;
  b11 = b35 * b47 + b3 * b11;
  b19 = b31 * b60 + b19 * b11;
  b11 = b31 * b47 + b3 * b11;
  b19 = b6 + (b29 * b49 + b5 * b66) + (b30 * b48 + b4 * b65) + b7 - (b32 * b63 + b22 * b55) + b21 + b20 + b19;
  b20 = b36 * b47 + b3 * b11;
  b21 = b37 * b47 + b3 * b20;
  b55 = b38 * b47 + b3 * b21;
  b22 = b39 * b47 + b3 * b55;
  b55 = b19 + (b36 * b59 + b18 * b11) + (b37 * b58 + b17 * b20) + (b38 * b57 + b16 * b21) + (b39 * b2 + b15 * b55);
  b3 = b55 + (b40 * b1 + b14 * b22) + EACH((-1.9572941063391263e-20)) * (b40 * b47 + b3 * b22);
  b13 = LOAD(given + 108) + (LOAD(given + 36) * b56 + b12 * LOAD(given + 96)) + (b41 * (EACH(2.0) * b46) + b13 * b3);
  b46 = EACH(0.08333333333333333) * b13;
  b47 = EACH(0.08333333333333333) * (LOAD(given + 44) + b12 * LOAD(given + 32) + b44 * b41);
  b44 = LOAD(given + 104) + (LOAD(given + 32) * b56 + b12 * LOAD(given + 92)) + (b41 * (EACH(2.0) * b45) + b44 * b3);
  b45 = EACH(0.08333333333333333) * b44;
  b3 = LOAD(given + 100) + (LOAD(given + 28) * b56 + b12 * LOAD(given + 88)) + (b41 * (EACH(2.0) * b43) + b42 * b3);
  b41 = EACH(0.08333333333333333) * (LOAD(given + 40) + b12 * LOAD(given + 28) + b42 * b41);
  b42 = EACH(0.08333333333333333) * b3;
  b3 = b34 * LOAD(given + 76) + LOAD(given + 16) * b46 - (b47 * LOAD(given + 80) + LOAD(given + 20) * b45) + b3;
  STORE(made + 0, b3);
  b44 = b44 - (b34 * LOAD(given + 72) + LOAD(given + 12) * b46) + (b41 * LOAD(given + 80) + LOAD(given + 20) * b42);
  STORE(made + 4, b44);
  b13 = b13 + (b47 * LOAD(given + 72) + LOAD(given + 12) * b45) - (b41 * LOAD(given + 76) + LOAD(given + 16) * b42);
  STORE(made + 8, b13);
  b13 = b47 * LOAD(given + 68) + LOAD(given + 8) * b45 - (b34 * LOAD(given + 64) + LOAD(given + 4) * b46);
  STORE(made + 12, b13);
  b46 = b34 * LOAD(given + 60) + LOAD(given + 0) * b46 - (b41 * LOAD(given + 68) + LOAD(given + 8) * b42);
  STORE(made + 16, b46);
  b45 = b41 * LOAD(given + 64) + LOAD(given + 4) * b42 - (b47 * LOAD(given + 60) + LOAD(given + 0) * b45);
  STORE(made + 20, b45);
}

static void MADE(nitinol_wire_derivatives_fwd1_adj1_increments)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 120, made += 24)
    EVERY_LANE(MADE(nitinol_wire_derivatives_fwd1_adj1_increments_turn)(given + lane, made + lane))
}
