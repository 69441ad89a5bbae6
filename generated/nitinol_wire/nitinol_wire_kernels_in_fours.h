/* Included once for each width of vectors. */
static void MADE(nitinol_wire_kernels_increments_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(nitinol_wire_kernels_increments)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 24, made += 36)
    EVERY_LANE(MADE(nitinol_wire_kernels_increments_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_kernels_pulls_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(nitinol_wire_kernels_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 92, made += 24)
    EVERY_LANE(MADE(nitinol_wire_kernels_pulls_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_kernels_variations_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20, b21, b22, b23, b24, b25, b26, b27, b28, b29, b30, b31;
  FOUR b32, b33;
  b0 = LOAD(given + 40) * LOAD(given + 32);
  b1 = b0 * LOAD(given + 32);
  b2 = LOAD(given + 40) * LOAD(given + 28);
  b3 = b2 * LOAD(given + 28);
  b4 = EACH(1.0) - (b1 + b3);
  b5 = LOAD(given + 36) * LOAD(given + 36);
  b6 = b5 / EACH(2.0);
  b7 = b6 * LOAD(given + 32);
  b8 = LOAD(given + 40) * LOAD(given + 24);
  b9 = b7 + b8 * LOAD(given + 28);
  b10 = b6 * LOAD(given + 28);
  b11 = b8 * LOAD(given + 32) - b10;
  b12 = LOAD(given + 44) * b4 + LOAD(given + 56) * b9 + LOAD(given + 68) * b11;
  b7 = b2 * LOAD(given + 24) - b7;
  b8 = b8 * LOAD(given + 24);
  b1 = EACH(1.0) - (b1 + b8);
  b13 = b6 * LOAD(given + 24);
  b2 = b13 + b2 * LOAD(given + 32);
  b14 = LOAD(given + 44) * b7 + LOAD(given + 56) * b1 + LOAD(given + 68) * b2;
  b15 = EACH(0.08333333333333333) * LOAD(given + 20);
  b10 = b10 + b0 * LOAD(given + 24);
  b13 = b0 * LOAD(given + 28) - b13;
  b8 = EACH(1.0) - (b3 + b8);
  b3 = LOAD(given + 44) * b10 + LOAD(given + 56) * b13 + LOAD(given + 68) * b8;
  b0 = EACH(0.08333333333333333) * LOAD(given + 16);
  b16 = LOAD(given + 48) * b4 + LOAD(given + 60) * b9 + LOAD(given + 72) * b11;
  b17 = LOAD(given + 48) * b7 + LOAD(given + 60) * b1 + LOAD(given + 72) * b2;
  b18 = LOAD(given + 48) * b10 + LOAD(given + 60) * b13 + LOAD(given + 72) * b8;
  b11 = LOAD(given + 52) * b4 + LOAD(given + 64) * b9 + LOAD(given + 76) * b11;
  b2 = LOAD(given + 52) * b7 + LOAD(given + 64) * b1 + LOAD(given + 76) * b2;
  b8 = LOAD(given + 52) * b10 + LOAD(given + 64) * b13 + LOAD(given + 76) * b8;
  b13 = EACH(0.08333333333333333) * LOAD(given + 12);
  b10 = EACH(0.08333333333333333) * LOAD(given + 8);
  b1 = EACH(0.08333333333333333) * LOAD(given + 4);
  b7 = EACH(0.08333333333333333) * LOAD(given + 0);
  b9 = LOAD(given + 76) * LOAD(given + 32);
  b9 = LOAD(given + 52) * LOAD(given + 24) + LOAD(given + 64) * LOAD(given + 28) + b9;
  b5 = EACH(0.5) / b5;
  b4 = LOAD(given + 68) * LOAD(given + 32);
  b4 = LOAD(given + 44) * LOAD(given + 24) + LOAD(given + 56) * LOAD(given + 28) + b4;
  b19 = LOAD(given + 72) * LOAD(given + 32);
  b19 = LOAD(given + 48) * LOAD(given + 24) + LOAD(given + 60) * LOAD(given + 28) + b19;
  b20 = b4 * b4 + b19 * b19 + b9 * b9;
  b21 = EACH((-2.186688975602072e-15)) + b20 * (EACH(6.576508197299464e-18) + EACH((-1.6014224506411032e-20)) * b20);
  b21 = b20 * (EACH((-1.1470745597729724e-10)) + b20 * (EACH(5.735372798864862e-13) + b20 * b21));
  b21 = b20 * (EACH((-1.6534391534391535e-06)) + b20 * (EACH(1.670140559029448e-08) + b21));
  b21 = EACH((-0.002777777777777778)) + b20 * (EACH(9.92063492063492e-05) + b21);
  b22 = b5 * b21 * (LOAD(given + 80) * b4 + LOAD(given + 84) * b19 + LOAD(given + 88) * b9);
  b21 = b5 * (LOAD(given + 40) + b20 * b21);
  b20 = b22 * b9 - b21 * LOAD(given + 88);
  b5 = b9 * b20;
  b23 = b22 * b19 - b21 * LOAD(given + 84);
  b24 = b19 * b23;
  b25 = LOAD(given + 88) / EACH(2.0);
  b26 = b4 * b23;
  b21 = b22 * b4 - b21 * LOAD(given + 80);
  b22 = b19 * b21;
  b27 = b4 * b20;
  b28 = LOAD(given + 84) / EACH(2.0);
  b29 = b9 * b21;
  b21 = b4 * b21;
  b4 = LOAD(given + 80) / EACH(2.0);
  b20 = b19 * b20;
  b23 = b9 * b23;
  b9 = LOAD(given + 76) * LOAD(given + 88);
  b9 = LOAD(given + 68) * LOAD(given + 80) + LOAD(given + 72) * LOAD(given + 84) + b9;
  b19 = LOAD(given + 52) * LOAD(given + 88);
  b19 = LOAD(given + 44) * LOAD(given + 80) + LOAD(given + 48) * LOAD(given + 84) + b19;
  b30 = LOAD(given + 64) * LOAD(given + 88);
  b30 = LOAD(given + 56) * LOAD(given + 80) + LOAD(given + 60) * LOAD(given + 84) + b30;
  b31 = LOAD(given + 40) * (LOAD(given + 32) * b19 - LOAD(given + 24) * b9) - b6 * b30;
  b32 = LOAD(given + 40) * (LOAD(given + 28) * b9 - LOAD(given + 32) * b30) - b6 * b19;
  b33 = EACH(0.08333333333333333) * (b9 + (LOAD(given + 24) * b31 - LOAD(given + 28) * b32));
  b9 = LOAD(given + 40) * (LOAD(given + 24) * b30 - LOAD(given + 28) * b19) - b6 * b9;
  b32 = EACH(0.08333333333333333) * (b30 + (LOAD(given + 32) * b32 - LOAD(given + 24) * b9));
  b30 = EACH((-1.0)) * b32;
  b6 = EACH((-1.0)) * b33;
  b31 = EACH(0.08333333333333333) * (b19 + (LOAD(given + 28) * b9 - LOAD(given + 32) * b31));
  b9 = EACH((-1.0)) * b31;
  STORE(made + 0, b12 - b14 * b15 + b3 * b0);
  STORE(made + 4, b16 - b17 * b15 + b18 * b0);
  STORE(made + 8, b11 - b2 * b15 + b8 * b0);
  STORE(made + 12, b12 * b15 + b14 - b3 * b13);
  STORE(made + 16, b16 * b15 + b17 - b18 * b13);
  STORE(made + 20, b11 * b15 + b2 - b8 * b13);
  STORE(made + 24, b14 * b13 - b12 * b0 + b3);
  STORE(made + 28, b17 * b13 - b16 * b0 + b18);
  STORE(made + 32, b2 * b13 - b11 * b0 + b8);
  STORE(made + 36, b14 * b10 - b3 * b1);
  STORE(made + 40, b17 * b10 - b18 * b1);
  STORE(made + 44, b2 * b10 - b8 * b1);
  STORE(made + 48, b3 * b7 - b12 * b10);
  STORE(made + 52, b18 * b7 - b16 * b10);
  STORE(made + 56, b8 * b7 - b11 * b10);
  STORE(made + 60, b12 * b1 - b14 * b7);
  STORE(made + 64, b16 * b1 - b17 * b7);
  STORE(made + 68, b11 * b1 - b2 * b7);
  STORE(made + 72, EACH((-1.0)) * (EACH(2.0) * (b5 + b24)));
  STORE(made + 76, b25 + b26 + b22);
  STORE(made + 80, b27 - b28 + b29);
  STORE(made + 84, b22 - b25 + b26);
  STORE(made + 88, EACH((-1.0)) * (EACH(2.0) * (b5 + b21)));
  STORE(made + 92, b4 + b20 + b23);
  STORE(made + 96, b28 + b29 + b27);
  STORE(made + 100, b23 - b4 + b20);
  STORE(made + 104, EACH((-1.0)) * (EACH(2.0) * (b24 + b21)));
  STORE(made + 108, b33);
  STORE(made + 112, b30);
  STORE(made + 116, b6);
  STORE(made + 120, b31);
  STORE(made + 124, b32);
  STORE(made + 128, b9);
  STORE(made + 132, b6);
  STORE(made + 136, b32);
  STORE(made + 140, b33);
  STORE(made + 144, b9);
  STORE(made + 148, b30);
  STORE(made + 152, b31);
}

static void MADE(nitinol_wire_kernels_variations)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 92, made += 156)
    EVERY_LANE(MADE(nitinol_wire_kernels_variations_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_kernels_fwd1_pulls_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(nitinol_wire_kernels_fwd1_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 184, made += 24)
    EVERY_LANE(MADE(nitinol_wire_kernels_fwd1_pulls_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_kernels_turnings_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16;
  b0 = LOAD(given + 40) * LOAD(given + 32);
  b1 = b0 * LOAD(given + 32);
  b2 = LOAD(given + 40) * LOAD(given + 28);
  b3 = b2 * LOAD(given + 28);
  b4 = EACH(1.0) - (b1 + b3);
  b5 = LOAD(given + 36) * LOAD(given + 36) / EACH(2.0);
  b6 = b5 * LOAD(given + 32);
  b7 = LOAD(given + 40) * LOAD(given + 24);
  b8 = b6 + b7 * LOAD(given + 28);
  b9 = b5 * LOAD(given + 28);
  b10 = b7 * LOAD(given + 32) - b9;
  b11 = LOAD(given + 44) * b4 + LOAD(given + 56) * b8 + LOAD(given + 68) * b10;
  b6 = b2 * LOAD(given + 24) - b6;
  b7 = b7 * LOAD(given + 24);
  b1 = EACH(1.0) - (b1 + b7);
  b5 = b5 * LOAD(given + 24);
  b2 = b5 + b2 * LOAD(given + 32);
  b12 = LOAD(given + 44) * b6 + LOAD(given + 56) * b1 + LOAD(given + 68) * b2;
  b13 = EACH(0.08333333333333333) * LOAD(given + 20);
  b9 = b9 + b0 * LOAD(given + 24);
  b5 = b0 * LOAD(given + 28) - b5;
  b7 = EACH(1.0) - (b3 + b7);
  b3 = LOAD(given + 44) * b9 + LOAD(given + 56) * b5 + LOAD(given + 68) * b7;
  b0 = EACH(0.08333333333333333) * LOAD(given + 16);
  b14 = LOAD(given + 48) * b4 + LOAD(given + 60) * b8 + LOAD(given + 72) * b10;
  b15 = LOAD(given + 48) * b6 + LOAD(given + 60) * b1 + LOAD(given + 72) * b2;
  b16 = LOAD(given + 48) * b9 + LOAD(given + 60) * b5 + LOAD(given + 72) * b7;
  b10 = LOAD(given + 52) * b4 + LOAD(given + 64) * b8 + LOAD(given + 76) * b10;
  b2 = LOAD(given + 52) * b6 + LOAD(given + 64) * b1 + LOAD(given + 76) * b2;
  b7 = LOAD(given + 52) * b9 + LOAD(given + 64) * b5 + LOAD(given + 76) * b7;
  b5 = EACH(0.08333333333333333) * LOAD(given + 12);
  b9 = EACH(0.08333333333333333) * LOAD(given + 8);
  b1 = EACH(0.08333333333333333) * LOAD(given + 4);
  b6 = EACH(0.08333333333333333) * LOAD(given + 0);
  STORE(made + 0, b11 - b12 * b13 + b3 * b0);
  STORE(made + 4, b14 - b15 * b13 + b16 * b0);
  STORE(made + 8, b10 - b2 * b13 + b7 * b0);
  STORE(made + 12, b11 * b13 + b12 - b3 * b5);
  STORE(made + 16, b14 * b13 + b15 - b16 * b5);
  STORE(made + 20, b10 * b13 + b2 - b7 * b5);
  STORE(made + 24, b12 * b5 - b11 * b0 + b3);
  STORE(made + 28, b15 * b5 - b14 * b0 + b16);
  STORE(made + 32, b2 * b5 - b10 * b0 + b7);
  STORE(made + 36, b12 * b9 - b3 * b1);
  STORE(made + 40, b15 * b9 - b16 * b1);
  STORE(made + 44, b2 * b9 - b7 * b1);
  STORE(made + 48, b3 * b6 - b11 * b9);
  STORE(made + 52, b16 * b6 - b14 * b9);
  STORE(made + 56, b7 * b6 - b10 * b9);
  STORE(made + 60, b11 * b1 - b12 * b6);
  STORE(made + 64, b14 * b1 - b15 * b6);
  STORE(made + 68, b10 * b1 - b2 * b6);
}

static void MADE(nitinol_wire_kernels_turnings)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 80, made += 72)
    EVERY_LANE(MADE(nitinol_wire_kernels_turnings_turn)(given + lane, made + lane))
}

static void MADE(nitinol_wire_k_jacobian_columns_0)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18;
  b0 = EACH(w[112]) * LOAD(turns + 72);
  b1 = EACH(w[124]) * LOAD(turns + 96);
  b1 = EACH(w[76]) * LOAD(turns + 0) + EACH(w[88]) * LOAD(turns + 24) + EACH(w[100]) * LOAD(turns + 48) + b0 + b1;
  b1 = b1 + EACH(w[136]) * LOAD(turns + 120);
  STORE(passed + 12, b1);
  b0 = EACH(w[113]) * LOAD(turns + 76);
  b2 = EACH(w[125]) * LOAD(turns + 100);
  b2 = EACH(w[77]) * LOAD(turns + 4) + EACH(w[89]) * LOAD(turns + 28) + EACH(w[101]) * LOAD(turns + 52) + b0 + b2;
  b2 = b2 + EACH(w[137]) * LOAD(turns + 124);
  STORE(passed + 112, b2);
  b2 = b1 + b2;
  STORE(passed + 76, b2);
  b0 = EACH(w[114]) * LOAD(turns + 80);
  b3 = EACH(w[126]) * LOAD(turns + 104);
  b3 = EACH(w[78]) * LOAD(turns + 8) + EACH(w[90]) * LOAD(turns + 32) + EACH(w[102]) * LOAD(turns + 56) + b0 + b3;
  b3 = b3 + EACH(w[138]) * LOAD(turns + 128);
  STORE(passed + 148, b3);
  b3 = b2 + b3;
  STORE(passed + 64, b3);
  b0 = EACH(w[115]) * LOAD(turns + 84);
  b4 = EACH(w[127]) * LOAD(turns + 108);
  b4 = EACH(w[79]) * LOAD(turns + 12) + EACH(w[91]) * LOAD(turns + 36) + EACH(w[103]) * LOAD(turns + 60) + b0 + b4;
  b4 = b4 + EACH(w[139]) * LOAD(turns + 132);
  STORE(passed + 164, b4);
  b4 = b3 + b4;
  STORE(passed + 52, b4);
  b0 = EACH(w[268]) * LOAD(turns + 88);
  b0 = EACH(w[232]) * LOAD(turns + 16) + EACH(w[244]) * LOAD(turns + 40) + EACH(w[256]) * LOAD(turns + 64) + b0;
  b0 = b0 + EACH(w[280]) * LOAD(turns + 112) + EACH(w[292]) * LOAD(turns + 136);
  STORE(passed + 128, b0);
  b0 = b4 + b0;
  STORE(passed + 40, b0);
  b5 = EACH(w[269]) * LOAD(turns + 92);
  b5 = EACH(w[233]) * LOAD(turns + 20) + EACH(w[245]) * LOAD(turns + 44) + EACH(w[257]) * LOAD(turns + 68) + b5;
  b5 = b5 + EACH(w[281]) * LOAD(turns + 116) + EACH(w[293]) * LOAD(turns + 140);
  STORE(passed + 92, b5);
  b5 = b0 + b5;
  STORE(passed + 28, b5);
  b6 = EACH(w[108]) * LOAD(turns + 72);
  b7 = EACH(w[120]) * LOAD(turns + 96);
  b7 = EACH(w[72]) * LOAD(turns + 0) + EACH(w[84]) * LOAD(turns + 24) + EACH(w[96]) * LOAD(turns + 48) + b6 + b7;
  b7 = b7 + EACH(w[132]) * LOAD(turns + 120);
  STORE(passed + 8, b7);
  b6 = EACH(w[109]) * LOAD(turns + 76);
  b8 = EACH(w[121]) * LOAD(turns + 100);
  b8 = EACH(w[73]) * LOAD(turns + 4) + EACH(w[85]) * LOAD(turns + 28) + EACH(w[97]) * LOAD(turns + 52) + b6 + b8;
  b8 = b8 + EACH(w[133]) * LOAD(turns + 124);
  STORE(passed + 108, b8);
  b8 = b7 + b8;
  STORE(passed + 72, b8);
  b6 = EACH(w[110]) * LOAD(turns + 80);
  b9 = EACH(w[122]) * LOAD(turns + 104);
  b9 = EACH(w[74]) * LOAD(turns + 8) + EACH(w[86]) * LOAD(turns + 32) + EACH(w[98]) * LOAD(turns + 56) + b6 + b9;
  b9 = b9 + EACH(w[134]) * LOAD(turns + 128);
  STORE(passed + 144, b9);
  b9 = b8 + b9;
  STORE(passed + 60, b9);
  b6 = EACH(w[111]) * LOAD(turns + 84);
  b10 = EACH(w[123]) * LOAD(turns + 108);
  b10 = EACH(w[75]) * LOAD(turns + 12) + EACH(w[87]) * LOAD(turns + 36) + EACH(w[99]) * LOAD(turns + 60) + b6 + b10;
  b10 = b10 + EACH(w[135]) * LOAD(turns + 132);
  STORE(passed + 160, b10);
  b10 = b9 + b10;
  STORE(passed + 48, b10);
  b6 = EACH(w[264]) * LOAD(turns + 88);
  b6 = EACH(w[228]) * LOAD(turns + 16) + EACH(w[240]) * LOAD(turns + 40) + EACH(w[252]) * LOAD(turns + 64) + b6;
  b6 = b6 + EACH(w[276]) * LOAD(turns + 112) + EACH(w[288]) * LOAD(turns + 136);
  STORE(passed + 124, b6);
  b6 = b10 + b6;
  STORE(passed + 36, b6);
  b11 = EACH(w[265]) * LOAD(turns + 92);
  b11 = EACH(w[229]) * LOAD(turns + 20) + EACH(w[241]) * LOAD(turns + 44) + EACH(w[253]) * LOAD(turns + 68) + b11;
  b11 = b11 + EACH(w[277]) * LOAD(turns + 116) + EACH(w[289]) * LOAD(turns + 140);
  STORE(passed + 88, b11);
  b11 = b6 + b11;
  STORE(passed + 24, b11);
  b12 = EACH(w[116]) * LOAD(turns + 72);
  b13 = EACH(w[128]) * LOAD(turns + 96);
  b13 = EACH(w[80]) * LOAD(turns + 0) + EACH(w[92]) * LOAD(turns + 24) + EACH(w[104]) * LOAD(turns + 48) + b12 + b13;
  b13 = b13 + EACH(w[140]) * LOAD(turns + 120);
  STORE(passed + 16, b13);
  b12 = EACH(w[117]) * LOAD(turns + 76);
  b14 = EACH(w[129]) * LOAD(turns + 100);
  b14 = EACH(w[81]) * LOAD(turns + 4) + EACH(w[93]) * LOAD(turns + 28) + EACH(w[105]) * LOAD(turns + 52) + b12 + b14;
  b14 = b14 + EACH(w[141]) * LOAD(turns + 124);
  STORE(passed + 116, b14);
  b14 = b13 + b14;
  STORE(passed + 80, b14);
  b12 = EACH(w[118]) * LOAD(turns + 80);
  b15 = EACH(w[130]) * LOAD(turns + 104);
  b15 = EACH(w[82]) * LOAD(turns + 8) + EACH(w[94]) * LOAD(turns + 32) + EACH(w[106]) * LOAD(turns + 56) + b12 + b15;
  b15 = b15 + EACH(w[142]) * LOAD(turns + 128);
  STORE(passed + 152, b15);
  b15 = b14 + b15;
  STORE(passed + 68, b15);
  b12 = EACH(w[119]) * LOAD(turns + 84);
  b16 = EACH(w[131]) * LOAD(turns + 108);
  b16 = EACH(w[83]) * LOAD(turns + 12) + EACH(w[95]) * LOAD(turns + 36) + EACH(w[107]) * LOAD(turns + 60) + b12 + b16;
  b16 = b16 + EACH(w[143]) * LOAD(turns + 132);
  STORE(passed + 168, b16);
  b16 = b15 + b16;
  STORE(passed + 56, b16);
  b12 = EACH(w[272]) * LOAD(turns + 88);
  b12 = EACH(w[236]) * LOAD(turns + 16) + EACH(w[248]) * LOAD(turns + 40) + EACH(w[260]) * LOAD(turns + 64) + b12;
  b12 = b12 + EACH(w[284]) * LOAD(turns + 112) + EACH(w[296]) * LOAD(turns + 136);
  STORE(passed + 132, b12);
  b12 = b16 + b12;
  STORE(passed + 44, b12);
  b17 = EACH(w[273]) * LOAD(turns + 92);
  b17 = EACH(w[237]) * LOAD(turns + 20) + EACH(w[249]) * LOAD(turns + 44) + EACH(w[261]) * LOAD(turns + 68) + b17;
  b17 = b17 + EACH(w[285]) * LOAD(turns + 116) + EACH(w[297]) * LOAD(turns + 140);
  STORE(passed + 96, b17);
  b17 = b12 + b17;
  STORE(passed + 32, b17);
  b18 = EACH(w[604]) * b5 - EACH(w[641]) * b11 + EACH(w[678]) * b17;
  STORE(passed + 84, b18);
  b18 = b18 + (EACH(w[679]) * b0 - EACH(w[680]) * b6 + EACH(w[681]) * b12);
  STORE(passed + 120, b18);
  b18 = b18 + (EACH(w[682]) * b4 - EACH(w[683]) * b10 + EACH(w[684]) * b16);
  STORE(passed + 156, b18);
  b18 = b18 + (EACH(w[685]) * b3 - EACH(w[686]) * b9 + EACH(w[687]) * b15);
  STORE(passed + 140, b18);
  b18 = b18 + (EACH(w[688]) * b2 - EACH(w[689]) * b8 + EACH(w[690]) * b14);
  STORE(passed + 104, b18);
  b7 = b18 + (EACH(w[691]) * b1 - EACH(w[692]) * b7 + EACH(w[693]) * b13) + EACH(w[144]) * b7 + EACH(w[156]) * b1;
  b13 = b7 + EACH(w[168]) * b13;
  STORE(passed + 176, b13);
  STORE(passed + 20, EACH(w[72]) * b13);
  b17 = EACH(w[697]) * b11 - EACH(w[698]) * b5 + EACH(w[699]) * b17;
  STORE(passed + 100, b17);
  b12 = b17 + (EACH(w[700]) * b6 - EACH(w[701]) * b0 + EACH(w[702]) * b12);
  STORE(passed + 136, b12);
  b16 = b12 + (EACH(w[703]) * b10 - EACH(w[704]) * b4 + EACH(w[705]) * b16);
  STORE(passed + 172, b16);
  STORE(passed + 0, b16 + (EACH(w[706]) * b9 - EACH(w[707]) * b3 + EACH(w[708]) * b15));
  STORE(passed + 4, EACH(w[709]) * b8 - EACH(w[710]) * b2 + EACH(w[711]) * b14);
}

static void MADE(nitinol_wire_k_jacobian_columns_1)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14;
  b0 = LOAD(passed + 0) + LOAD(passed + 4);
  b1 = b0 + (EACH(w[712]) * LOAD(passed + 8) - EACH(w[713]) * LOAD(passed + 12) + EACH(w[714]) * LOAD(passed + 16));
  b1 = b1 + EACH(w[148]) * LOAD(passed + 8) + EACH(w[160]) * LOAD(passed + 12) + EACH(w[172]) * LOAD(passed + 16);
  STORE(passed + 260, b1);
  b2 = EACH(w[718]) * LOAD(passed + 24) + EACH(w[719]) * LOAD(passed + 28) - EACH(w[720]) * LOAD(passed + 32);
  b3 = b2 + (EACH(w[721]) * LOAD(passed + 36) + EACH(w[722]) * LOAD(passed + 40) - EACH(w[723]) * LOAD(passed + 44));
  b4 = b3 + (EACH(w[724]) * LOAD(passed + 48) + EACH(w[725]) * LOAD(passed + 52) - EACH(w[726]) * LOAD(passed + 56));
  b5 = b4 + (EACH(w[727]) * LOAD(passed + 60) + EACH(w[728]) * LOAD(passed + 64) - EACH(w[729]) * LOAD(passed + 68));
  b6 = b5 + (EACH(w[730]) * LOAD(passed + 72) + EACH(w[731]) * LOAD(passed + 76) - EACH(w[732]) * LOAD(passed + 80));
  b7 = b6 + (EACH(w[733]) * LOAD(passed + 8) + EACH(w[734]) * LOAD(passed + 12) - EACH(w[735]) * LOAD(passed + 16));
  b7 = b7 + EACH(w[152]) * LOAD(passed + 8) + EACH(w[164]) * LOAD(passed + 12) + EACH(w[176]) * LOAD(passed + 16);
  STORE(passed + 264, b7);
  b8 = EACH(w[220]) * LOAD(turns + 120);
  b8 = LOAD(passed + 20) + EACH(w[76]) * b1 + EACH(w[80]) * b7 + EACH(w[212]) * LOAD(turns + 96) + b8;
  b9 = EACH(w[301]) * LOAD(passed + 88);
  b10 = EACH(w[313]) * LOAD(passed + 92);
  b11 = EACH(w[325]) * LOAD(passed + 96);
  b11 = EACH(w[741]) * LOAD(passed + 44) - EACH(w[742]) * LOAD(passed + 40) + LOAD(passed + 84) + b9 + b10 + b11;
  STORE(passed + 268, b11);
  b10 = EACH(w[305]) * LOAD(passed + 88);
  b9 = EACH(w[317]) * LOAD(passed + 92);
  b12 = EACH(w[329]) * LOAD(passed + 96);
  b12 = EACH(w[742]) * LOAD(passed + 36) - EACH(w[746]) * LOAD(passed + 44) + LOAD(passed + 100) + b10 + b9 + b12;
  STORE(passed + 180, b12);
  b2 = EACH(w[746]) * LOAD(passed + 40) - EACH(w[741]) * LOAD(passed + 36) + b2 + EACH(w[309]) * LOAD(passed + 88);
  b2 = b2 + EACH(w[321]) * LOAD(passed + 92) + EACH(w[333]) * LOAD(passed + 96);
  STORE(passed + 188, b2);
  b9 = EACH(w[377]) * LOAD(turns + 140);
  b9 = EACH(w[229]) * b11 + EACH(w[233]) * b12 + EACH(w[237]) * b2 + EACH(w[369]) * LOAD(turns + 116) + b9;
  b2 = b8 + b9;
  STORE(passed + 248, b2);
  b12 = EACH(w[145]) * LOAD(passed + 108);
  b10 = EACH(w[157]) * LOAD(passed + 112);
  b13 = EACH(w[169]) * LOAD(passed + 116);
  b13 = EACH(w[755]) * LOAD(passed + 16) - EACH(w[756]) * LOAD(passed + 12) + LOAD(passed + 104) + b12 + b10 + b13;
  STORE(passed + 200, b13);
  b0 = EACH(w[756]) * LOAD(passed + 8) - EACH(w[760]) * LOAD(passed + 16) + b0 + EACH(w[149]) * LOAD(passed + 108);
  b0 = b0 + EACH(w[161]) * LOAD(passed + 112) + EACH(w[173]) * LOAD(passed + 116);
  STORE(passed + 204, b0);
  b6 = EACH(w[760]) * LOAD(passed + 12) - EACH(w[755]) * LOAD(passed + 8) + b6 + EACH(w[153]) * LOAD(passed + 108);
  b6 = b6 + EACH(w[165]) * LOAD(passed + 112) + EACH(w[177]) * LOAD(passed + 116);
  STORE(passed + 208, b6);
  b10 = EACH(w[221]) * LOAD(turns + 124);
  b10 = EACH(w[73]) * b13 + EACH(w[77]) * b0 + EACH(w[81]) * b6 + EACH(w[213]) * LOAD(turns + 100) + b10;
  b6 = EACH(w[300]) * LOAD(passed + 124);
  b0 = EACH(w[312]) * LOAD(passed + 128);
  b13 = EACH(w[324]) * LOAD(passed + 132);
  b13 = EACH(w[769]) * LOAD(passed + 56) - EACH(w[770]) * LOAD(passed + 52) + LOAD(passed + 120) + b6 + b0 + b13;
  STORE(passed + 212, b13);
  b0 = EACH(w[304]) * LOAD(passed + 124);
  b6 = EACH(w[316]) * LOAD(passed + 128);
  b12 = EACH(w[328]) * LOAD(passed + 132);
  b12 = EACH(w[770]) * LOAD(passed + 48) - EACH(w[774]) * LOAD(passed + 56) + LOAD(passed + 136) + b0 + b6 + b12;
  STORE(passed + 216, b12);
  b3 = EACH(w[774]) * LOAD(passed + 52) - EACH(w[769]) * LOAD(passed + 48) + b3 + EACH(w[308]) * LOAD(passed + 124);
  b3 = b3 + EACH(w[320]) * LOAD(passed + 128) + EACH(w[332]) * LOAD(passed + 132);
  STORE(passed + 220, b3);
  b6 = EACH(w[376]) * LOAD(turns + 136);
  b6 = EACH(w[228]) * b13 + EACH(w[232]) * b12 + EACH(w[236]) * b3 + EACH(w[368]) * LOAD(turns + 112) + b6;
  b3 = b10 + b6;
  STORE(passed + 252, b3);
  b12 = EACH(w[146]) * LOAD(passed + 144);
  b13 = EACH(w[158]) * LOAD(passed + 148);
  b0 = EACH(w[170]) * LOAD(passed + 152);
  b0 = EACH(w[783]) * LOAD(passed + 80) - EACH(w[784]) * LOAD(passed + 76) + LOAD(passed + 140) + b12 + b13 + b0;
  STORE(passed + 224, b0);
  b13 = EACH(w[150]) * LOAD(passed + 144);
  b12 = EACH(w[162]) * LOAD(passed + 148);
  b14 = EACH(w[174]) * LOAD(passed + 152);
  b14 = EACH(w[784]) * LOAD(passed + 72) - EACH(w[788]) * LOAD(passed + 80) + LOAD(passed + 0) + b13 + b12 + b14;
  STORE(passed + 228, b14);
  b5 = EACH(w[788]) * LOAD(passed + 76) - EACH(w[783]) * LOAD(passed + 72) + b5 + EACH(w[154]) * LOAD(passed + 144);
  b5 = b5 + EACH(w[166]) * LOAD(passed + 148) + EACH(w[178]) * LOAD(passed + 152);
  STORE(passed + 232, b5);
  b12 = EACH(w[222]) * LOAD(turns + 128);
  b12 = EACH(w[74]) * b0 + EACH(w[78]) * b14 + EACH(w[82]) * b5 + EACH(w[214]) * LOAD(turns + 104) + b12;
  b5 = EACH(w[147]) * LOAD(passed + 160);
  b14 = EACH(w[159]) * LOAD(passed + 164);
  b0 = EACH(w[171]) * LOAD(passed + 168);
  b0 = EACH(w[797]) * LOAD(passed + 68) - EACH(w[798]) * LOAD(passed + 64) + LOAD(passed + 156) + b5 + b14 + b0;
  STORE(passed + 236, b0);
  b14 = EACH(w[151]) * LOAD(passed + 160);
  b5 = EACH(w[163]) * LOAD(passed + 164);
  b13 = EACH(w[175]) * LOAD(passed + 168);
  b13 = EACH(w[798]) * LOAD(passed + 60) - EACH(w[802]) * LOAD(passed + 68) + LOAD(passed + 172) + b14 + b5 + b13;
  STORE(passed + 240, b13);
  b4 = EACH(w[802]) * LOAD(passed + 64) - EACH(w[797]) * LOAD(passed + 60) + b4 + EACH(w[155]) * LOAD(passed + 160);
  b4 = b4 + EACH(w[167]) * LOAD(passed + 164) + EACH(w[179]) * LOAD(passed + 168);
  STORE(passed + 244, b4);
  b5 = EACH(w[223]) * LOAD(turns + 132);
  b5 = EACH(w[75]) * b0 + EACH(w[79]) * b13 + EACH(w[83]) * b4 + EACH(w[215]) * LOAD(turns + 108) + b5;
  b4 = b12 + b5;
  STORE(passed + 256, b4);
  b4 = EACH((-5.245986011368956)) * b2 + EACH((-14.332300318855587)) * b3 + EACH((-19.578286330224547)) * b4;
  STORE(passed + 272, b4);
  b5 = EACH(4.894571582556137) * (b12 - b5);
  STORE(passed + 196, EACH(4.894571582556136) * (b8 - b9) + EACH(9.78914316511227) * (b10 - b6) + b5);
  b7 = EACH(w[108]) * LOAD(passed + 176) + EACH(w[112]) * b1 + EACH(w[116]) * b7 + EACH(w[188]) * LOAD(turns + 24);
  STORE(passed + 192, b7 + EACH(w[196]) * LOAD(turns + 48));
  STORE(passed + 184, EACH(w[265]) * b11);
}

static void MADE(nitinol_wire_k_jacobian_columns_2)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20, b21, b22, b23, b24, b25, b26, b27, b28;
  b0 = EACH(w[345]) * LOAD(turns + 44);
  b1 = EACH(w[353]) * LOAD(turns + 68);
  b1 = LOAD(passed + 184) + EACH(w[269]) * LOAD(passed + 180) + EACH(w[273]) * LOAD(passed + 188) + b0 + b1;
  b0 = EACH(w[109]) * LOAD(passed + 200) + EACH(w[113]) * LOAD(passed + 204) + EACH(w[117]) * LOAD(passed + 208);
  b0 = b0 + EACH(w[189]) * LOAD(turns + 28) + EACH(w[197]) * LOAD(turns + 52);
  b2 = EACH(w[264]) * LOAD(passed + 212) + EACH(w[268]) * LOAD(passed + 216) + EACH(w[272]) * LOAD(passed + 220);
  b2 = b2 + EACH(w[344]) * LOAD(turns + 40) + EACH(w[352]) * LOAD(turns + 64);
  b3 = EACH((-5.245986011368952)) * (b0 + b2);
  b4 = EACH(w[110]) * LOAD(passed + 224) + EACH(w[114]) * LOAD(passed + 228) + EACH(w[118]) * LOAD(passed + 232);
  b4 = b4 + EACH(w[190]) * LOAD(turns + 32) + EACH(w[198]) * LOAD(turns + 56);
  b5 = EACH(w[111]) * LOAD(passed + 236) + EACH(w[115]) * LOAD(passed + 240) + EACH(w[119]) * LOAD(passed + 244);
  b5 = b5 + EACH(w[191]) * LOAD(turns + 36) + EACH(w[199]) * LOAD(turns + 60);
  b6 = EACH((-9.789143165112277)) * (b4 + b5);
  b7 = EACH(7.341857373834205) * LOAD(passed + 256);
  b8 = EACH(1.9672447542633584) * (LOAD(passed + 192) - b1);
  b8 = EACH((-4.238823331135015)) * LOAD(passed + 248) + EACH((-3.103034042699186)) * LOAD(passed + 252) + b7 + b8;
  b7 = EACH(w[204]) * LOAD(turns + 72);
  b7 = EACH(w[84]) * LOAD(passed + 176) + EACH(w[88]) * LOAD(passed + 260) + EACH(w[92]) * LOAD(passed + 264) + b7;
  b7 = b7 + EACH(w[224]) * LOAD(turns + 120);
  b9 = EACH(w[241]) * LOAD(passed + 268) + EACH(w[245]) * LOAD(passed + 180) + EACH(w[249]) * LOAD(passed + 188);
  b9 = b9 + EACH(w[361]) * LOAD(turns + 92) + EACH(w[381]) * LOAD(turns + 140);
  b10 = b7 + b9;
  b11 = EACH(w[205]) * LOAD(turns + 76);
  b11 = EACH(w[85]) * LOAD(passed + 200) + EACH(w[89]) * LOAD(passed + 204) + EACH(w[93]) * LOAD(passed + 208) + b11;
  b11 = b11 + EACH(w[225]) * LOAD(turns + 124);
  b12 = EACH(w[240]) * LOAD(passed + 212) + EACH(w[244]) * LOAD(passed + 216) + EACH(w[248]) * LOAD(passed + 220);
  b12 = b12 + EACH(w[360]) * LOAD(turns + 88) + EACH(w[380]) * LOAD(turns + 136);
  b13 = b11 + b12;
  b14 = EACH(w[206]) * LOAD(turns + 80);
  b14 = EACH(w[86]) * LOAD(passed + 224) + EACH(w[90]) * LOAD(passed + 228) + EACH(w[94]) * LOAD(passed + 232) + b14;
  b14 = b14 + EACH(w[226]) * LOAD(turns + 128);
  b15 = EACH(w[207]) * LOAD(turns + 84);
  b15 = EACH(w[87]) * LOAD(passed + 236) + EACH(w[91]) * LOAD(passed + 240) + EACH(w[95]) * LOAD(passed + 244) + b15;
  b15 = b15 + EACH(w[227]) * LOAD(turns + 132);
  b16 = b14 + b15;
  b15 = EACH(4.894571582556137) * (b14 - b15);
  b14 = EACH(w[120]) * LOAD(passed + 176) + EACH(w[124]) * LOAD(passed + 260) + EACH(w[128]) * LOAD(passed + 264);
  b14 = b14 + EACH(w[180]) * LOAD(turns + 0) + EACH(w[200]) * LOAD(turns + 48);
  b17 = EACH(w[277]) * LOAD(passed + 268) + EACH(w[281]) * LOAD(passed + 180) + EACH(w[285]) * LOAD(passed + 188);
  b17 = b17 + EACH(w[337]) * LOAD(turns + 20) + EACH(w[357]) * LOAD(turns + 68);
  b18 = EACH((-0.7028288576256386)) * (b14 + b17);
  b19 = EACH(w[121]) * LOAD(passed + 200) + EACH(w[125]) * LOAD(passed + 204) + EACH(w[129]) * LOAD(passed + 208);
  b19 = b19 + EACH(w[181]) * LOAD(turns + 4) + EACH(w[201]) * LOAD(turns + 52);
  b20 = EACH(w[276]) * LOAD(passed + 212) + EACH(w[280]) * LOAD(passed + 216) + EACH(w[284]) * LOAD(passed + 220);
  b20 = b20 + EACH(w[336]) * LOAD(turns + 16) + EACH(w[356]) * LOAD(turns + 64);
  b21 = EACH((-5.245986011368952)) * (b19 + b20);
  b22 = EACH(w[122]) * LOAD(passed + 224) + EACH(w[126]) * LOAD(passed + 228) + EACH(w[130]) * LOAD(passed + 232);
  b22 = b22 + EACH(w[182]) * LOAD(turns + 8) + EACH(w[202]) * LOAD(turns + 56);
  b23 = EACH(w[123]) * LOAD(passed + 236) + EACH(w[127]) * LOAD(passed + 240) + EACH(w[131]) * LOAD(passed + 244);
  b23 = b23 + EACH(w[183]) * LOAD(turns + 12) + EACH(w[203]) * LOAD(turns + 60);
  b24 = EACH((-9.789143165112277)) * (b22 + b23);
  b17 = EACH(1.9672447542633584) * (b14 - b17);
  b17 = EACH((-4.238823331135015)) * b10 + EACH((-3.103034042699186)) * b13 + EACH(7.341857373834205) * b16 + b17;
  b14 = EACH(w[208]) * LOAD(turns + 72);
  b14 = EACH(w[96]) * LOAD(passed + 176) + EACH(w[100]) * LOAD(passed + 260) + EACH(w[104]) * LOAD(passed + 264) + b14;
  b25 = EACH(w[253]) * LOAD(passed + 268) + EACH(w[257]) * LOAD(passed + 180) + EACH(w[261]) * LOAD(passed + 188);
  b25 = b25 + EACH(w[365]) * LOAD(turns + 92) + EACH(w[373]) * LOAD(turns + 116);
  b26 = EACH(w[209]) * LOAD(turns + 76);
  b26 = EACH(w[97]) * LOAD(passed + 200) + EACH(w[101]) * LOAD(passed + 204) + EACH(w[105]) * LOAD(passed + 208) + b26;
  b27 = EACH(w[252]) * LOAD(passed + 212) + EACH(w[256]) * LOAD(passed + 216) + EACH(w[260]) * LOAD(passed + 220);
  b27 = b27 + EACH(w[364]) * LOAD(turns + 88) + EACH(w[372]) * LOAD(turns + 112);
  b27 = EACH((-16.528815055282227)) * (b26 + EACH(w[217]) * LOAD(turns + 100) + b27);
  b26 = EACH(w[210]) * LOAD(turns + 80);
  b26 = EACH(w[98]) * LOAD(passed + 224) + EACH(w[102]) * LOAD(passed + 228) + EACH(w[106]) * LOAD(passed + 232) + b26;
  b28 = EACH(w[211]) * LOAD(turns + 84);
  b28 = EACH(w[99]) * LOAD(passed + 236) + EACH(w[103]) * LOAD(passed + 240) + EACH(w[107]) * LOAD(passed + 244) + b28;
  b28 = b26 + EACH(w[218]) * LOAD(turns + 104) + (b28 + EACH(w[219]) * LOAD(turns + 108));
  b28 = EACH((-22.57878125997022)) * b28;
  STORE(columns + 0, LOAD(passed + 272));
  STORE(columns + 8, LOAD(passed + 196) + EACH((-0.7028288576256386)) * (LOAD(passed + 192) + b1) + b3 + b6);
  STORE(columns + 16, b8 + EACH(10.749225239141685) * (b0 - b2) + EACH(7.341857373834208) * (b4 - b5));
  b16 = EACH((-5.245986011368956)) * b10 + EACH((-14.332300318855587)) * b13 + EACH((-19.578286330224547)) * b16;
  STORE(columns + 24, b16);
  b24 = EACH(4.894571582556136) * (b7 - b9) + EACH(9.78914316511227) * (b11 - b12) + b15 + b18 + b21 + b24;
  STORE(columns + 32, b24);
  STORE(columns + 40, b17 + EACH(10.749225239141685) * (b19 - b20) + EACH(7.341857373834208) * (b22 - b23));
  STORE(columns + 48, EACH((-6.049966204687987)) * (b14 + EACH(w[216]) * LOAD(turns + 96) + b25) + b27 + b28);
}

static void MADE(nitinol_wire_k_jacobian_columns)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed, int groups) {
  int group;
  for (group = 0; group < groups; group++, turns += 144, columns += 4) {
    EVERY_LANE(MADE(nitinol_wire_k_jacobian_columns_0)(w, turns + lane, columns + lane, passed + lane))
    EVERY_LANE(MADE(nitinol_wire_k_jacobian_columns_1)(w, turns + lane, columns + lane, passed + lane))
    EVERY_LANE(MADE(nitinol_wire_k_jacobian_columns_2)(w, turns + lane, columns + lane, passed + lane))
  }
}

static void MADE(nitinol_wire_k_tip_jacobian_columns_0)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7;
  b0 = EACH(w[239]) * LOAD(turns + 72);
  b1 = EACH(w[251]) * LOAD(turns + 96);
  b1 = EACH(w[203]) * LOAD(turns + 0) + EACH(w[215]) * LOAD(turns + 24) + EACH(w[227]) * LOAD(turns + 48) + b0 + b1;
  b1 = b1 + EACH(w[263]) * LOAD(turns + 120);
  STORE(passed + 4, b1);
  b0 = EACH(w[240]) * LOAD(turns + 76);
  b2 = EACH(w[252]) * LOAD(turns + 100);
  b2 = EACH(w[204]) * LOAD(turns + 4) + EACH(w[216]) * LOAD(turns + 28) + EACH(w[228]) * LOAD(turns + 52) + b0 + b2;
  b2 = b1 + (b2 + EACH(w[264]) * LOAD(turns + 124));
  STORE(passed + 8, b2);
  b0 = EACH(w[241]) * LOAD(turns + 80);
  b3 = EACH(w[253]) * LOAD(turns + 104);
  b3 = EACH(w[205]) * LOAD(turns + 8) + EACH(w[217]) * LOAD(turns + 32) + EACH(w[229]) * LOAD(turns + 56) + b0 + b3;
  b3 = b2 + (b3 + EACH(w[265]) * LOAD(turns + 128));
  STORE(passed + 12, b3);
  b0 = EACH(w[242]) * LOAD(turns + 84);
  b0 = EACH(w[206]) * LOAD(turns + 12) + EACH(w[218]) * LOAD(turns + 36) + EACH(w[230]) * LOAD(turns + 60) + b0;
  b0 = b3 + (b0 + EACH(w[254]) * LOAD(turns + 108) + EACH(w[266]) * LOAD(turns + 132));
  STORE(passed + 16, b0);
  b4 = EACH(w[311]) * LOAD(turns + 88);
  b4 = EACH(w[275]) * LOAD(turns + 16) + EACH(w[287]) * LOAD(turns + 40) + EACH(w[299]) * LOAD(turns + 64) + b4;
  b4 = b0 + (b4 + EACH(w[323]) * LOAD(turns + 112) + EACH(w[335]) * LOAD(turns + 136));
  STORE(passed + 20, b4);
  b5 = EACH(w[312]) * LOAD(turns + 92);
  b5 = EACH(w[276]) * LOAD(turns + 20) + EACH(w[288]) * LOAD(turns + 44) + EACH(w[300]) * LOAD(turns + 68) + b5;
  b5 = b4 + (b5 + EACH(w[324]) * LOAD(turns + 116) + EACH(w[336]) * LOAD(turns + 140));
  STORE(passed + 24, b5);
  b5 = EACH(w[544]) * b5;
  b6 = EACH(w[243]) * LOAD(turns + 72);
  b7 = EACH(w[255]) * LOAD(turns + 96);
  b7 = EACH(w[207]) * LOAD(turns + 0) + EACH(w[219]) * LOAD(turns + 24) + EACH(w[231]) * LOAD(turns + 48) + b6 + b7;
  b7 = b7 + EACH(w[267]) * LOAD(turns + 120);
  STORE(passed + 28, b7);
  b5 = EACH(w[509]) * b1 + EACH(w[516]) * b2 + EACH(w[523]) * b3 + EACH(w[530]) * b0 + EACH(w[537]) * b4 + b5;
  b4 = EACH(w[244]) * LOAD(turns + 76);
  b0 = EACH(w[256]) * LOAD(turns + 100);
  b0 = EACH(w[208]) * LOAD(turns + 4) + EACH(w[220]) * LOAD(turns + 28) + EACH(w[232]) * LOAD(turns + 52) + b4 + b0;
  b0 = b7 + (b0 + EACH(w[268]) * LOAD(turns + 124));
  STORE(passed + 32, b0);
  b4 = EACH(w[245]) * LOAD(turns + 80);
  b3 = EACH(w[257]) * LOAD(turns + 104);
  b3 = EACH(w[209]) * LOAD(turns + 8) + EACH(w[221]) * LOAD(turns + 32) + EACH(w[233]) * LOAD(turns + 56) + b4 + b3;
  b3 = b0 + (b3 + EACH(w[269]) * LOAD(turns + 128));
  STORE(passed + 36, b3);
  b4 = EACH(w[246]) * LOAD(turns + 84);
  b4 = EACH(w[210]) * LOAD(turns + 12) + EACH(w[222]) * LOAD(turns + 36) + EACH(w[234]) * LOAD(turns + 60) + b4;
  b4 = b3 + (b4 + EACH(w[258]) * LOAD(turns + 108) + EACH(w[270]) * LOAD(turns + 132));
  STORE(passed + 40, b4);
  b2 = EACH(w[315]) * LOAD(turns + 88);
  b2 = EACH(w[279]) * LOAD(turns + 16) + EACH(w[291]) * LOAD(turns + 40) + EACH(w[303]) * LOAD(turns + 64) + b2;
  b2 = b4 + (b2 + EACH(w[327]) * LOAD(turns + 112) + EACH(w[339]) * LOAD(turns + 136));
  STORE(passed + 44, b2);
  b1 = EACH(w[316]) * LOAD(turns + 92);
  b1 = EACH(w[280]) * LOAD(turns + 20) + EACH(w[292]) * LOAD(turns + 44) + EACH(w[304]) * LOAD(turns + 68) + b1;
  b1 = b2 + (b1 + EACH(w[328]) * LOAD(turns + 116) + EACH(w[340]) * LOAD(turns + 140));
  STORE(passed + 48, b1);
  b2 = b5 - EACH(w[551]) * b7 - EACH(w[558]) * b0 - EACH(w[565]) * b3 - EACH(w[572]) * b4 - EACH(w[579]) * b2;
  STORE(passed + 0, b2 - EACH(w[586]) * b1);
}

static void MADE(nitinol_wire_k_tip_jacobian_columns_1)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7;
  b0 = EACH(w[235]) * LOAD(turns + 72);
  b1 = EACH(w[247]) * LOAD(turns + 96);
  b1 = EACH(w[199]) * LOAD(turns + 0) + EACH(w[211]) * LOAD(turns + 24) + EACH(w[223]) * LOAD(turns + 48) + b0 + b1;
  b1 = b1 + EACH(w[259]) * LOAD(turns + 120);
  b0 = EACH(w[236]) * LOAD(turns + 76);
  b2 = EACH(w[248]) * LOAD(turns + 100);
  b2 = EACH(w[200]) * LOAD(turns + 4) + EACH(w[212]) * LOAD(turns + 28) + EACH(w[224]) * LOAD(turns + 52) + b0 + b2;
  b2 = b1 + (b2 + EACH(w[260]) * LOAD(turns + 124));
  b0 = EACH(w[237]) * LOAD(turns + 80);
  b3 = EACH(w[249]) * LOAD(turns + 104);
  b3 = EACH(w[201]) * LOAD(turns + 8) + EACH(w[213]) * LOAD(turns + 32) + EACH(w[225]) * LOAD(turns + 56) + b0 + b3;
  b3 = b2 + (b3 + EACH(w[261]) * LOAD(turns + 128));
  b0 = EACH(w[238]) * LOAD(turns + 84);
  b0 = EACH(w[202]) * LOAD(turns + 12) + EACH(w[214]) * LOAD(turns + 36) + EACH(w[226]) * LOAD(turns + 60) + b0;
  b0 = b3 + (b0 + EACH(w[250]) * LOAD(turns + 108) + EACH(w[262]) * LOAD(turns + 132));
  b4 = EACH(w[307]) * LOAD(turns + 88);
  b4 = EACH(w[271]) * LOAD(turns + 16) + EACH(w[283]) * LOAD(turns + 40) + EACH(w[295]) * LOAD(turns + 64) + b4;
  b4 = b0 + (b4 + EACH(w[319]) * LOAD(turns + 112) + EACH(w[331]) * LOAD(turns + 136));
  b5 = EACH(w[308]) * LOAD(turns + 92);
  b5 = EACH(w[272]) * LOAD(turns + 20) + EACH(w[284]) * LOAD(turns + 44) + EACH(w[296]) * LOAD(turns + 68) + b5;
  b5 = b4 + (b5 + EACH(w[320]) * LOAD(turns + 116) + EACH(w[332]) * LOAD(turns + 140));
  b6 = EACH(w[586]) * b5;
  b6 = EACH(w[551]) * b1 + EACH(w[558]) * b2 + EACH(w[565]) * b3 + EACH(w[572]) * b0 + EACH(w[579]) * b4 + b6;
  b6 = b6 - EACH(w[623]) * LOAD(passed + 4) - EACH(w[624]) * LOAD(passed + 8) - EACH(w[625]) * LOAD(passed + 12);
  b6 = b6 - EACH(w[626]) * LOAD(passed + 16) - EACH(w[627]) * LOAD(passed + 20) - EACH(w[628]) * LOAD(passed + 24);
  b7 = EACH(w[544]) * b5;
  b7 = EACH(w[509]) * b1 + EACH(w[516]) * b2 + EACH(w[523]) * b3 + EACH(w[530]) * b0 + EACH(w[537]) * b4 + b7;
  b7 = EACH(w[623]) * LOAD(passed + 28) - b7 + EACH(w[624]) * LOAD(passed + 32) + EACH(w[625]) * LOAD(passed + 36);
  b4 = (b5 * EACH(w[139]) + LOAD(passed + 24) * EACH(w[136]) + LOAD(passed + 48) * EACH(w[137])) / EACH(2.0);
  b0 = (LOAD(passed + 24) * EACH(w[138]) - b5 * EACH(w[137]) + LOAD(passed + 48) * EACH(w[139])) / EACH(2.0);
  b3 = (b5 * EACH(w[138]) + LOAD(passed + 24) * EACH(w[137]) - LOAD(passed + 48) * EACH(w[136])) / EACH(2.0);
  b5 = (b5 * EACH(w[136]) - LOAD(passed + 24) * EACH(w[139]) + LOAD(passed + 48) * EACH(w[138])) / EACH(2.0);
  STORE(columns + 0, EACH(2.220446049250313e-16) * LOAD(passed + 0) + b6);
  b7 = b7 + EACH(w[626]) * LOAD(passed + 40) + EACH(w[627]) * LOAD(passed + 44) + EACH(w[628]) * LOAD(passed + 48);
  STORE(columns + 8, b7);
  STORE(columns + 16, EACH(2.220446049250313e-16) * b6 - LOAD(passed + 0));
  STORE(columns + 24, EACH((-1.0)) * (EACH(0.7071067811865476) * b4 + EACH(0.7071067811865475) * b0));
  STORE(columns + 32, EACH(0.7071067811865476) * b3 + EACH(0.7071067811865475) * b5);
  STORE(columns + 40, EACH(0.7071067811865476) * b0 - EACH(0.7071067811865475) * b4);
  STORE(columns + 48, EACH(0.7071067811865476) * b5 - EACH(0.7071067811865475) * b3);
}

static void MADE(nitinol_wire_k_tip_jacobian_columns)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed, int groups) {
  int group;
  for (group = 0; group < groups; group++, turns += 144, columns += 4) {
    EVERY_LANE(MADE(nitinol_wire_k_tip_jacobian_columns_0)(w, turns + lane, columns + lane, passed + lane))
    EVERY_LANE(MADE(nitinol_wire_k_tip_jacobian_columns_1)(w, turns + lane, columns + lane, passed + lane))
  }
}
