/* Included once for each width of vectors. */
static void MADE(follower_reissner_kernels_increments_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(follower_reissner_kernels_increments)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 24, made += 36)
    EVERY_LANE(MADE(follower_reissner_kernels_increments_turn)(given + lane, made + lane))
}

static void MADE(follower_reissner_kernels_pulls_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(follower_reissner_kernels_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 92, made += 24)
    EVERY_LANE(MADE(follower_reissner_kernels_pulls_turn)(given + lane, made + lane))
}

static void MADE(follower_reissner_kernels_variations_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(follower_reissner_kernels_variations)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 92, made += 156)
    EVERY_LANE(MADE(follower_reissner_kernels_variations_turn)(given + lane, made + lane))
}

static void MADE(follower_reissner_kernels_fwd1_pulls_turn)(const casadi_real *given, casadi_real *made) {
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

static void MADE(follower_reissner_kernels_fwd1_pulls)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 184, made += 24)
    EVERY_LANE(MADE(follower_reissner_kernels_fwd1_pulls_turn)(given + lane, made + lane))
}

static void MADE(follower_reissner_kernels_increments_4_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6;
  b0 = LOAD(given + 0) * LOAD(given + 24) + LOAD(given + 4) * LOAD(given + 28) + LOAD(given + 8) * LOAD(given + 32);
  b1 = LOAD(given + 20) * LOAD(given + 20);
  b1 = (LOAD(given + 12) * LOAD(given + 12) + LOAD(given + 16) * LOAD(given + 16) + b1) / EACH(240.0);
  b1 = EACH(1.0) + b0 / EACH(360.0) - b1;
  b0 = LOAD(given + 0) * LOAD(given + 12) + LOAD(given + 4) * LOAD(given + 16) + LOAD(given + 8) * LOAD(given + 20);
  b0 = b0 / EACH(240.0);
  b2 = LOAD(given + 0) * LOAD(given + 0) + LOAD(given + 4) * LOAD(given + 4) + LOAD(given + 8) * LOAD(given + 8);
  b2 = b2 / EACH(720.0);
  b3 = EACH(0.08333333333333333) - EACH(2.0) * b2;
  b2 = EACH(0.08333333333333333) + b2;
  b4 = b2 * LOAD(given + 4) + LOAD(given + 28) / EACH(240.0);
  b5 = b2 * LOAD(given + 8) + LOAD(given + 32) / EACH(240.0);
  b6 = b4 * LOAD(given + 20) - b5 * LOAD(given + 16);
  b6 = b1 * LOAD(given + 0) + b0 * LOAD(given + 12) + b3 * LOAD(given + 24) + b6;
  b2 = b2 * LOAD(given + 0) + LOAD(given + 24) / EACH(240.0);
  b5 = b5 * LOAD(given + 12) - b2 * LOAD(given + 20);
  b5 = b1 * LOAD(given + 4) + b0 * LOAD(given + 16) + b3 * LOAD(given + 28) + b5;
  b4 = b2 * LOAD(given + 16) - b4 * LOAD(given + 12);
  b4 = b1 * LOAD(given + 8) + b0 * LOAD(given + 20) + b3 * LOAD(given + 32) + b4;
  b3 = b6 * b6 + b5 * b5 + b4 * b4;
  b0 = EACH((-2.8114572543455206e-15)) + b3 * (EACH(8.22063524662433e-18) + EACH((-1.9572941063391263e-20)) * b3);
  b0 = b3 * (EACH((-1.6059043836821613e-10)) + b3 * (EACH(7.647163731819816e-13) + b3 * b0));
  b0 = b3 * (EACH((-2.7557319223985893e-06)) + b3 * (EACH(2.505210838544172e-08) + b0));
  b0 = EACH(0.16666666666666666) + b3 * (EACH((-0.008333333333333333)) + b3 * (EACH(0.0001984126984126984) + b0));
  b1 = EACH(3.920664999224027e-14) + b3 * (EACH((-4.667458332409556e-17)) + EACH(4.289943320229371e-20) * b3);
  b1 = b3 * (EACH(1.076457782186949e-08) + b3 * (EACH((-2.446494959515793e-11)) + b3 * b1));
  b1 = b3 * (EACH(0.0005208333333333333) + b3 * (EACH((-3.1001984126984127e-06)) + b1));
  b1 = EACH(1.0) + b3 * (EACH((-0.041666666666666664)) + b1);
  b2 = b1 / EACH(2.0);
  STORE(made + 0, (EACH(1.0) - b3 * b0) / b1);
  STORE(made + 4, b2 * b6);
  STORE(made + 8, b2 * b5);
  STORE(made + 12, b2 * b4);
  STORE(made + 16, b6);
  STORE(made + 20, b5);
  STORE(made + 24, b4);
  STORE(made + 28, b1);
  STORE(made + 32, b0);
}

static void MADE(follower_reissner_kernels_increments_4)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 36, made += 36)
    EVERY_LANE(MADE(follower_reissner_kernels_increments_4_turn)(given + lane, made + lane))
}

static void MADE(follower_reissner_kernels_pulls_5_turn)(const casadi_real *given, casadi_real *made) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17;
  b0 = LOAD(given + 0) * LOAD(given + 0) + LOAD(given + 4) * LOAD(given + 4) + LOAD(given + 8) * LOAD(given + 8);
  b0 = b0 / EACH(720.0);
  b1 = EACH(0.08333333333333333) + b0;
  b2 = LOAD(given + 88) * LOAD(given + 100);
  b2 = LOAD(given + 80) * LOAD(given + 92) + LOAD(given + 84) * LOAD(given + 96) + b2;
  b3 = LOAD(given + 64) * LOAD(given + 100);
  b3 = LOAD(given + 56) * LOAD(given + 92) + LOAD(given + 60) * LOAD(given + 96) + b3;
  b4 = LOAD(given + 48) * LOAD(given + 48) / EACH(2.0);
  b5 = LOAD(given + 76) * LOAD(given + 100);
  b5 = LOAD(given + 68) * LOAD(given + 92) + LOAD(given + 72) * LOAD(given + 96) + b5;
  b6 = LOAD(given + 52) * (LOAD(given + 44) * b3 - LOAD(given + 36) * b2) - b4 * b5;
  b7 = LOAD(given + 52) * (LOAD(given + 40) * b2 - LOAD(given + 44) * b5) - b4 * b3;
  b8 = b2 + (LOAD(given + 36) * b6 - LOAD(given + 40) * b7);
  b2 = LOAD(given + 52) * (LOAD(given + 36) * b5 - LOAD(given + 40) * b3) - b4 * b2;
  b7 = b5 + (LOAD(given + 44) * b7 - LOAD(given + 36) * b2);
  b5 = LOAD(given + 16) * b8 - LOAD(given + 20) * b7;
  b6 = b3 + (LOAD(given + 40) * b2 - LOAD(given + 44) * b6);
  b2 = LOAD(given + 12) * b7 - LOAD(given + 16) * b6;
  b3 = LOAD(given + 20) * b6 - LOAD(given + 12) * b8;
  b4 = EACH(2.0) * (EACH((-1.0)) * (LOAD(given + 32) * b8 + LOAD(given + 28) * b7 + LOAD(given + 24) * b6));
  b4 = EACH(0.001388888888888889) * (LOAD(given + 0) * b5 + LOAD(given + 8) * b2 + LOAD(given + 4) * b3 + b4);
  b9 = EACH(0.004166666666666667) * (LOAD(given + 20) * b8 + LOAD(given + 16) * b7 + LOAD(given + 12) * b6);
  b10 = LOAD(given + 0) * LOAD(given + 24) + LOAD(given + 4) * LOAD(given + 28) + LOAD(given + 8) * LOAD(given + 32);
  b11 = LOAD(given + 20) * LOAD(given + 20);
  b11 = (LOAD(given + 12) * LOAD(given + 12) + LOAD(given + 16) * LOAD(given + 16) + b11) / EACH(240.0);
  b11 = EACH(1.0) + b10 / EACH(360.0) - b11;
  b10 = LOAD(given + 8) * b8 + LOAD(given + 4) * b7 + LOAD(given + 0) * b6;
  b12 = EACH(0.002777777777777778) * b10;
  b13 = b1 * LOAD(given + 8) + LOAD(given + 32) / EACH(240.0);
  b14 = b1 * LOAD(given + 4) + LOAD(given + 28) / EACH(240.0);
  b15 = LOAD(given + 0) * LOAD(given + 12) + LOAD(given + 4) * LOAD(given + 16) + LOAD(given + 8) * LOAD(given + 20);
  b15 = b15 / EACH(240.0);
  b10 = EACH(0.004166666666666667) * b10;
  b16 = b1 * LOAD(given + 0) + LOAD(given + 24) / EACH(240.0);
  b0 = EACH(0.08333333333333333) - EACH(2.0) * b0;
  b17 = b1 * b5 + EACH(2.0) * LOAD(given + 0) * b4 + LOAD(given + 12) * b9 + b11 * b6 + LOAD(given + 24) * b12;
  STORE(made + 0, b17);
  b17 = b11 * b7 + b1 * b3 + EACH(2.0) * LOAD(given + 4) * b4 + LOAD(given + 16) * b9 + LOAD(given + 28) * b12;
  STORE(made + 4, b17);
  b4 = b11 * b8 + b1 * b2 + EACH(2.0) * LOAD(given + 8) * b4 + LOAD(given + 20) * b9 + LOAD(given + 32) * b12;
  STORE(made + 8, b4);
  b4 = b13 * b7 - b14 * b8 + b15 * b6 + LOAD(given + 0) * b9 - EACH(2.0) * LOAD(given + 12) * b10;
  STORE(made + 12, b4);
  b13 = b16 * b8 + b15 * b7 - b13 * b6 + LOAD(given + 4) * b9 - EACH(2.0) * LOAD(given + 16) * b10;
  STORE(made + 16, b13);
  b10 = b15 * b8 - b16 * b7 + b14 * b6 + LOAD(given + 8) * b9 - EACH(2.0) * LOAD(given + 20) * b10;
  STORE(made + 20, b10);
  STORE(made + 24, EACH(0.004166666666666667) * b5 + b0 * b6 + LOAD(given + 0) * b12);
  STORE(made + 28, b0 * b7 + EACH(0.004166666666666667) * b3 + LOAD(given + 4) * b12);
  STORE(made + 32, b0 * b8 + EACH(0.004166666666666667) * b2 + LOAD(given + 8) * b12);
}

static void MADE(follower_reissner_kernels_pulls_5)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 104, made += 36)
    EVERY_LANE(MADE(follower_reissner_kernels_pulls_5_turn)(given + lane, made + lane))
}

static void MADE(follower_reissner_kernels_chain_turn)(const casadi_real *given, casadi_real *made) {
  made[0] = given[0] * given[4] - given[1] * given[5] - given[2] * given[6] - given[3] * given[7];
  made[1] = given[0] * given[5] + given[1] * given[4] + given[2] * given[7] - given[3] * given[6];
  made[2] = given[0] * given[6] - given[1] * given[7] + given[2] * given[4] + given[3] * given[5];
  made[3] = given[0] * given[7] + given[1] * given[6] - given[2] * given[5] + given[3] * given[4];
}

static void MADE(follower_reissner_kernels_chain)(const casadi_real *given, casadi_real *made, int turns) {
  int turn;
  for (turn = 0; turn < turns; turn++, given += 8, made += 4)
    MADE(follower_reissner_kernels_chain_turn)(given, made);
}

static void MADE(follower_reissner_k_jacobian_columns_0)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20;
  b0 = EACH(w[112]) * LOAD(turns + 60);
  b1 = EACH(w[124]) * LOAD(turns + 80);
  b1 = EACH(w[76]) * LOAD(turns + 0) + EACH(w[88]) * LOAD(turns + 20) + EACH(w[100]) * LOAD(turns + 40) + b0 + b1;
  b1 = b1 + EACH(w[136]) * LOAD(turns + 100);
  STORE(passed + 72, b1);
  b0 = EACH(w[113]) * LOAD(turns + 64);
  b2 = EACH(w[125]) * LOAD(turns + 84);
  b2 = EACH(w[77]) * LOAD(turns + 4) + EACH(w[89]) * LOAD(turns + 24) + EACH(w[101]) * LOAD(turns + 44) + b0 + b2;
  b2 = b2 + EACH(w[137]) * LOAD(turns + 104);
  STORE(passed + 124, b2);
  b2 = b1 + b2;
  STORE(passed + 60, b2);
  b0 = EACH(w[114]) * LOAD(turns + 68);
  b3 = EACH(w[126]) * LOAD(turns + 88);
  b3 = EACH(w[78]) * LOAD(turns + 8) + EACH(w[90]) * LOAD(turns + 28) + EACH(w[102]) * LOAD(turns + 48) + b0 + b3;
  b3 = b3 + EACH(w[138]) * LOAD(turns + 108);
  STORE(passed + 156, b3);
  b3 = b2 + b3;
  STORE(passed + 44, b3);
  b0 = EACH(w[115]) * LOAD(turns + 72);
  b4 = EACH(w[127]) * LOAD(turns + 92);
  b4 = EACH(w[79]) * LOAD(turns + 12) + EACH(w[91]) * LOAD(turns + 32) + EACH(w[103]) * LOAD(turns + 52) + b0 + b4;
  b4 = b4 + EACH(w[139]) * LOAD(turns + 112);
  STORE(passed + 140, b4);
  b4 = b3 + b4;
  STORE(passed + 24, b4);
  b0 = EACH(w[268]) * LOAD(turns + 76);
  b0 = EACH(w[232]) * LOAD(turns + 16) + EACH(w[244]) * LOAD(turns + 36) + EACH(w[256]) * LOAD(turns + 56) + b0;
  b0 = b0 + EACH(w[280]) * LOAD(turns + 96) + EACH(w[292]) * LOAD(turns + 116);
  STORE(passed + 108, b0);
  b0 = b4 + b0;
  STORE(passed + 84, b0);
  b5 = EACH(w[108]) * LOAD(turns + 60);
  b6 = EACH(w[120]) * LOAD(turns + 80);
  b6 = EACH(w[72]) * LOAD(turns + 0) + EACH(w[84]) * LOAD(turns + 20) + EACH(w[96]) * LOAD(turns + 40) + b5 + b6;
  b6 = b6 + EACH(w[132]) * LOAD(turns + 100);
  STORE(passed + 68, b6);
  b5 = EACH(w[109]) * LOAD(turns + 64);
  b7 = EACH(w[121]) * LOAD(turns + 84);
  b7 = EACH(w[73]) * LOAD(turns + 4) + EACH(w[85]) * LOAD(turns + 24) + EACH(w[97]) * LOAD(turns + 44) + b5 + b7;
  b7 = b7 + EACH(w[133]) * LOAD(turns + 104);
  STORE(passed + 120, b7);
  b7 = b6 + b7;
  STORE(passed + 56, b7);
  b5 = EACH(w[110]) * LOAD(turns + 68);
  b8 = EACH(w[122]) * LOAD(turns + 88);
  b8 = EACH(w[74]) * LOAD(turns + 8) + EACH(w[86]) * LOAD(turns + 28) + EACH(w[98]) * LOAD(turns + 48) + b5 + b8;
  b8 = b8 + EACH(w[134]) * LOAD(turns + 108);
  STORE(passed + 152, b8);
  b8 = b7 + b8;
  STORE(passed + 40, b8);
  b5 = EACH(w[111]) * LOAD(turns + 72);
  b9 = EACH(w[123]) * LOAD(turns + 92);
  b9 = EACH(w[75]) * LOAD(turns + 12) + EACH(w[87]) * LOAD(turns + 32) + EACH(w[99]) * LOAD(turns + 52) + b5 + b9;
  b9 = b9 + EACH(w[135]) * LOAD(turns + 112);
  STORE(passed + 136, b9);
  b9 = b8 + b9;
  STORE(passed + 20, b9);
  b5 = EACH(w[264]) * LOAD(turns + 76);
  b5 = EACH(w[228]) * LOAD(turns + 16) + EACH(w[240]) * LOAD(turns + 36) + EACH(w[252]) * LOAD(turns + 56) + b5;
  b5 = b5 + EACH(w[276]) * LOAD(turns + 96) + EACH(w[288]) * LOAD(turns + 116);
  STORE(passed + 104, b5);
  b5 = b9 + b5;
  STORE(passed + 12, b5);
  b10 = EACH(w[116]) * LOAD(turns + 60);
  b11 = EACH(w[128]) * LOAD(turns + 80);
  b11 = EACH(w[80]) * LOAD(turns + 0) + EACH(w[92]) * LOAD(turns + 20) + EACH(w[104]) * LOAD(turns + 40) + b10 + b11;
  b11 = b11 + EACH(w[140]) * LOAD(turns + 100);
  STORE(passed + 76, b11);
  b10 = EACH(w[117]) * LOAD(turns + 64);
  b12 = EACH(w[129]) * LOAD(turns + 84);
  b12 = EACH(w[81]) * LOAD(turns + 4) + EACH(w[93]) * LOAD(turns + 24) + EACH(w[105]) * LOAD(turns + 44) + b10 + b12;
  b12 = b12 + EACH(w[141]) * LOAD(turns + 104);
  STORE(passed + 128, b12);
  b12 = b11 + b12;
  STORE(passed + 64, b12);
  b10 = EACH(w[118]) * LOAD(turns + 68);
  b13 = EACH(w[130]) * LOAD(turns + 88);
  b13 = EACH(w[82]) * LOAD(turns + 8) + EACH(w[94]) * LOAD(turns + 28) + EACH(w[106]) * LOAD(turns + 48) + b10 + b13;
  b13 = b13 + EACH(w[142]) * LOAD(turns + 108);
  STORE(passed + 160, b13);
  b13 = b12 + b13;
  STORE(passed + 48, b13);
  b10 = EACH(w[119]) * LOAD(turns + 72);
  b14 = EACH(w[131]) * LOAD(turns + 92);
  b14 = EACH(w[83]) * LOAD(turns + 12) + EACH(w[95]) * LOAD(turns + 32) + EACH(w[107]) * LOAD(turns + 52) + b10 + b14;
  b14 = b14 + EACH(w[143]) * LOAD(turns + 112);
  STORE(passed + 144, b14);
  b14 = b13 + b14;
  STORE(passed + 28, b14);
  b10 = EACH(w[272]) * LOAD(turns + 76);
  b10 = EACH(w[236]) * LOAD(turns + 16) + EACH(w[248]) * LOAD(turns + 36) + EACH(w[260]) * LOAD(turns + 56) + b10;
  b10 = b10 + EACH(w[284]) * LOAD(turns + 96) + EACH(w[296]) * LOAD(turns + 116);
  STORE(passed + 112, b10);
  b10 = b14 + b10;
  STORE(passed + 16, b10);
  b15 = EACH(w[661]) * b5 - EACH(w[662]) * b10;
  b16 = EACH(0.019999999999999993) * b15;
  STORE(passed + 88, b16);
  b17 = EACH(w[662]) * b0 - EACH(w[664]) * b5;
  b18 = EACH(0.019999999999999993) * b17;
  STORE(passed + 272, b18);
  b19 = EACH(w[666]) * b10 - EACH(w[667]) * b0;
  b19 = EACH(w[598]) * b0 - EACH(w[629]) * b5 + EACH(w[660]) * b10 + (EACH(w[663]) * b16 - EACH(w[665]) * b18) - b19;
  STORE(passed + 100, b19);
  b16 = EACH(0.1803715206000056) * b15;
  STORE(passed + 92, b16);
  b20 = EACH(0.1803715206000056) * b17;
  STORE(passed + 32, b20);
  b14 = EACH(w[668]) * b4 - EACH(w[669]) * b9 + EACH(w[670]) * b14 + (EACH(w[671]) * b16 - EACH(w[672]) * b20);
  b14 = b19 + b14;
  STORE(passed + 132, b14);
  b15 = EACH(0.29962847939999443) * b15;
  STORE(passed + 96, b15);
  b17 = EACH(0.29962847939999443) * b17;
  STORE(passed + 52, b17);
  b13 = EACH(w[673]) * b3 - EACH(w[674]) * b8 + EACH(w[675]) * b13 + (EACH(w[676]) * b15 - EACH(w[677]) * b17);
  b13 = b14 + b13;
  STORE(passed + 148, b13);
  b17 = EACH(w[678]) * b2 - EACH(w[679]) * b7 + EACH(w[680]) * b12 + (EACH(w[681]) * b15 - EACH(w[682]) * b17);
  b17 = b13 + b17;
  STORE(passed + 116, b17);
  b20 = EACH(w[683]) * b1 - EACH(w[684]) * b6 + EACH(w[685]) * b11 + (EACH(w[686]) * b16 - EACH(w[687]) * b20);
  b11 = b17 + b20 + EACH(w[144]) * b6 + EACH(w[156]) * b1 + EACH(w[168]) * b11;
  STORE(passed + 196, b11);
  STORE(passed + 80, EACH(w[72]) * b11);
  STORE(passed + 8, EACH(w[691]) * b5 - EACH(w[692]) * b0 + EACH(w[693]) * b10);
  STORE(passed + 4, EACH(w[694]) * b18);
  b0 = EACH(w[664]) * b10 - EACH(w[661]) * b0;
  STORE(passed + 36, b0);
  STORE(passed + 0, EACH(0.019999999999999993) * b0);
}

static void MADE(follower_reissner_k_jacobian_columns_1)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10;
  b0 = EACH(w[667]) * LOAD(passed + 12) - EACH(w[695]) * LOAD(passed + 16);
  b0 = LOAD(passed + 8) + (LOAD(passed + 4) - EACH(w[663]) * LOAD(passed + 0)) - b0;
  b1 = EACH(0.1803715206000056) * LOAD(passed + 36);
  STORE(passed + 276, b1);
  b2 = EACH(w[699]) * LOAD(passed + 32) - EACH(w[671]) * b1;
  b2 = EACH(w[696]) * LOAD(passed + 20) - EACH(w[697]) * LOAD(passed + 24) + EACH(w[698]) * LOAD(passed + 28) + b2;
  b2 = b0 + b2;
  b3 = EACH(0.29962847939999443) * LOAD(passed + 36);
  STORE(passed + 280, b3);
  b4 = EACH(w[703]) * LOAD(passed + 52) - EACH(w[676]) * b3;
  b4 = EACH(w[700]) * LOAD(passed + 40) - EACH(w[701]) * LOAD(passed + 44) + EACH(w[702]) * LOAD(passed + 48) + b4;
  b4 = b2 + b4;
  b5 = EACH(w[707]) * LOAD(passed + 52) - EACH(w[681]) * b3;
  b5 = EACH(w[704]) * LOAD(passed + 56) - EACH(w[705]) * LOAD(passed + 60) + EACH(w[706]) * LOAD(passed + 64) + b5;
  b5 = b4 + b5;
  b6 = EACH(w[711]) * LOAD(passed + 32) - EACH(w[686]) * b1;
  b6 = EACH(w[708]) * LOAD(passed + 68) - EACH(w[709]) * LOAD(passed + 72) + EACH(w[710]) * LOAD(passed + 76) + b6;
  b7 = EACH(w[172]) * LOAD(passed + 76);
  b7 = b5 + b6 + EACH(w[148]) * LOAD(passed + 68) + EACH(w[160]) * LOAD(passed + 72) + b7;
  STORE(passed + 200, b7);
  b6 = EACH(w[665]) * LOAD(passed + 0) - EACH(w[694]) * LOAD(passed + 88);
  b6 = EACH(w[715]) * LOAD(passed + 12) + EACH(w[716]) * LOAD(passed + 84) - EACH(w[717]) * LOAD(passed + 16) + b6;
  b6 = b6 - (EACH(w[695]) * LOAD(passed + 84) - EACH(w[666]) * LOAD(passed + 12));
  b8 = EACH(w[672]) * b1 - EACH(w[699]) * LOAD(passed + 92);
  b8 = EACH(w[718]) * LOAD(passed + 20) + EACH(w[719]) * LOAD(passed + 24) - EACH(w[720]) * LOAD(passed + 28) + b8;
  b8 = b6 + b8;
  b9 = EACH(w[677]) * b3 - EACH(w[703]) * LOAD(passed + 96);
  b9 = EACH(w[721]) * LOAD(passed + 40) + EACH(w[722]) * LOAD(passed + 44) - EACH(w[723]) * LOAD(passed + 48) + b9;
  b9 = b8 + b9;
  STORE(passed + 172, b9);
  b3 = EACH(w[682]) * b3 - EACH(w[707]) * LOAD(passed + 96);
  b3 = EACH(w[724]) * LOAD(passed + 56) + EACH(w[725]) * LOAD(passed + 60) - EACH(w[726]) * LOAD(passed + 64) + b3;
  b3 = b9 + b3;
  b1 = EACH(w[687]) * b1 - EACH(w[711]) * LOAD(passed + 92);
  b1 = EACH(w[727]) * LOAD(passed + 68) + EACH(w[728]) * LOAD(passed + 72) - EACH(w[729]) * LOAD(passed + 76) + b1;
  b9 = EACH(w[176]) * LOAD(passed + 76);
  b9 = b3 + b1 + EACH(w[152]) * LOAD(passed + 68) + EACH(w[164]) * LOAD(passed + 72) + b9;
  STORE(passed + 204, b9);
  b1 = EACH(w[220]) * LOAD(turns + 100);
  b1 = LOAD(passed + 80) + EACH(w[76]) * b7 + EACH(w[80]) * b9 + EACH(w[212]) * LOAD(turns + 80) + b1;
  STORE(passed + 180, b1);
  b9 = EACH(w[300]) * LOAD(passed + 104);
  b7 = EACH(w[312]) * LOAD(passed + 108);
  b10 = EACH(w[324]) * LOAD(passed + 112);
  b10 = EACH(w[735]) * LOAD(passed + 28) - EACH(w[736]) * LOAD(passed + 24) + LOAD(passed + 100) + b9 + b7 + b10;
  STORE(passed + 208, b10);
  b0 = EACH(w[736]) * LOAD(passed + 20) - EACH(w[740]) * LOAD(passed + 28) + b0 + EACH(w[304]) * LOAD(passed + 104);
  b0 = b0 + EACH(w[316]) * LOAD(passed + 108) + EACH(w[328]) * LOAD(passed + 112);
  STORE(passed + 212, b0);
  b6 = EACH(w[740]) * LOAD(passed + 24) - EACH(w[735]) * LOAD(passed + 20) + b6 + EACH(w[308]) * LOAD(passed + 104);
  b6 = b6 + EACH(w[320]) * LOAD(passed + 108) + EACH(w[332]) * LOAD(passed + 112);
  STORE(passed + 216, b6);
  b7 = EACH(w[376]) * LOAD(turns + 116);
  b7 = EACH(w[228]) * b10 + EACH(w[232]) * b0 + EACH(w[236]) * b6 + EACH(w[368]) * LOAD(turns + 96) + b7;
  STORE(passed + 184, b7);
  b7 = b1 + b7;
  STORE(passed + 248, b7);
  b1 = EACH(w[145]) * LOAD(passed + 120);
  b6 = EACH(w[157]) * LOAD(passed + 124);
  b0 = EACH(w[169]) * LOAD(passed + 128);
  b0 = EACH(w[749]) * LOAD(passed + 76) - EACH(w[750]) * LOAD(passed + 72) + LOAD(passed + 116) + b1 + b6 + b0;
  STORE(passed + 220, b0);
  b5 = EACH(w[750]) * LOAD(passed + 68) - EACH(w[754]) * LOAD(passed + 76) + b5 + EACH(w[149]) * LOAD(passed + 120);
  b5 = b5 + EACH(w[161]) * LOAD(passed + 124) + EACH(w[173]) * LOAD(passed + 128);
  STORE(passed + 224, b5);
  b3 = EACH(w[754]) * LOAD(passed + 72) - EACH(w[749]) * LOAD(passed + 68) + b3 + EACH(w[153]) * LOAD(passed + 120);
  b3 = b3 + EACH(w[165]) * LOAD(passed + 124) + EACH(w[177]) * LOAD(passed + 128);
  STORE(passed + 228, b3);
  b6 = EACH(w[221]) * LOAD(turns + 104);
  b6 = EACH(w[73]) * b0 + EACH(w[77]) * b5 + EACH(w[81]) * b3 + EACH(w[213]) * LOAD(turns + 84) + b6;
  STORE(passed + 188, b6);
  b3 = EACH(w[147]) * LOAD(passed + 136);
  b5 = EACH(w[159]) * LOAD(passed + 140);
  b0 = EACH(w[171]) * LOAD(passed + 144);
  b0 = EACH(w[763]) * LOAD(passed + 48) - EACH(w[764]) * LOAD(passed + 44) + LOAD(passed + 132) + b3 + b5 + b0;
  STORE(passed + 232, b0);
  b2 = EACH(w[764]) * LOAD(passed + 40) - EACH(w[768]) * LOAD(passed + 48) + b2 + EACH(w[151]) * LOAD(passed + 136);
  b2 = b2 + EACH(w[163]) * LOAD(passed + 140) + EACH(w[175]) * LOAD(passed + 144);
  STORE(passed + 236, b2);
  b8 = EACH(w[768]) * LOAD(passed + 44) - EACH(w[763]) * LOAD(passed + 40) + b8 + EACH(w[155]) * LOAD(passed + 136);
  b8 = b8 + EACH(w[167]) * LOAD(passed + 140) + EACH(w[179]) * LOAD(passed + 144);
  STORE(passed + 240, b8);
  b5 = EACH(w[223]) * LOAD(turns + 112);
  b5 = EACH(w[75]) * b0 + EACH(w[79]) * b2 + EACH(w[83]) * b8 + EACH(w[215]) * LOAD(turns + 92) + b5;
  STORE(passed + 192, b5);
  b5 = b6 + b5;
  STORE(passed + 252, b5);
  STORE(passed + 176, EACH((-11.451515875011848)) * b7 + EACH((-29.980457783490014)) * b5);
  b5 = EACH(w[146]) * LOAD(passed + 152);
  b7 = EACH(w[158]) * LOAD(passed + 156);
  b6 = EACH(w[170]) * LOAD(passed + 160);
  b6 = EACH(w[777]) * LOAD(passed + 64) - EACH(w[778]) * LOAD(passed + 60) + LOAD(passed + 148) + b5 + b7 + b6;
  STORE(passed + 244, b6);
  STORE(passed + 168, EACH(w[74]) * b6);
  STORE(passed + 164, EACH(w[778]) * LOAD(passed + 56) - EACH(w[782]) * LOAD(passed + 64) + b4);
}

static void MADE(follower_reissner_k_jacobian_columns_2)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13;
  b0 = EACH(w[174]) * LOAD(passed + 160);
  b0 = LOAD(passed + 164) + EACH(w[150]) * LOAD(passed + 152) + EACH(w[162]) * LOAD(passed + 156) + b0;
  STORE(passed + 264, b0);
  b1 = EACH(w[154]) * LOAD(passed + 152);
  b2 = EACH(w[166]) * LOAD(passed + 156);
  b3 = EACH(w[178]) * LOAD(passed + 160);
  b3 = EACH(w[782]) * LOAD(passed + 60) - EACH(w[777]) * LOAD(passed + 56) + LOAD(passed + 172) + b1 + b2 + b3;
  STORE(passed + 268, b3);
  b2 = EACH(w[222]) * LOAD(turns + 108);
  b2 = LOAD(passed + 168) + EACH(w[78]) * b0 + EACH(w[82]) * b3 + EACH(w[214]) * LOAD(turns + 88) + b2;
  STORE(passed + 284, LOAD(passed + 176) + EACH((-37.05788381695633)) * b2);
  b1 = LOAD(passed + 180) - LOAD(passed + 184);
  b4 = LOAD(passed + 188) - LOAD(passed + 192);
  b5 = EACH(w[108]) * LOAD(passed + 196) + EACH(w[112]) * LOAD(passed + 200) + EACH(w[116]) * LOAD(passed + 204);
  b5 = b5 + EACH(w[188]) * LOAD(turns + 20) + EACH(w[196]) * LOAD(turns + 40);
  b6 = EACH(w[264]) * LOAD(passed + 208) + EACH(w[268]) * LOAD(passed + 212) + EACH(w[272]) * LOAD(passed + 216);
  b6 = b6 + EACH(w[344]) * LOAD(turns + 36) + EACH(w[352]) * LOAD(turns + 56);
  b7 = b5 + b6;
  b8 = EACH(w[109]) * LOAD(passed + 220) + EACH(w[113]) * LOAD(passed + 224) + EACH(w[117]) * LOAD(passed + 228);
  b8 = b8 + EACH(w[189]) * LOAD(turns + 24) + EACH(w[197]) * LOAD(turns + 44);
  b9 = EACH(w[111]) * LOAD(passed + 232) + EACH(w[115]) * LOAD(passed + 236) + EACH(w[119]) * LOAD(passed + 240);
  b9 = b9 + EACH(w[191]) * LOAD(turns + 32) + EACH(w[199]) * LOAD(turns + 52);
  b10 = b8 + b9;
  b11 = EACH((-14.990228891745012)) * b10;
  b12 = EACH(w[110]) * LOAD(passed + 244) + EACH(w[114]) * b0 + EACH(w[118]) * b3 + EACH(w[190]) * LOAD(turns + 28);
  b12 = b12 + EACH(w[198]) * LOAD(turns + 48);
  b11 = EACH(10.357993414625463) * b1 + EACH(16.759585400111586) * b4 + EACH((-2.1870449207727667)) * b7 + b11;
  STORE(passed + 288, b11 + EACH((-22.903031750023718)) * b12);
  b6 = EACH(5.934602143709016) * (b5 - b6);
  b6 = EACH((-8.379792700055793)) * LOAD(passed + 248) + EACH((-2.0314756838908778e-15)) * LOAD(passed + 252) + b6;
  STORE(passed + 292, b6 + EACH(25.139378100167388) * (b8 - b9) + EACH(16.759585400111586) * b2);
  b10 = EACH((-14.053339586010956)) * b10;
  b10 = EACH(5.884745025948962) * b1 + EACH((-9.427266787562763)) * b4 + EACH((-10.16909205552639)) * b7 + b10;
  STORE(passed + 296, b10 + EACH(31.073980243876413) * b12);
  b12 = EACH(w[204]) * LOAD(turns + 60);
  b12 = EACH(w[84]) * LOAD(passed + 196) + EACH(w[88]) * LOAD(passed + 200) + EACH(w[92]) * LOAD(passed + 204) + b12;
  b12 = b12 + EACH(w[224]) * LOAD(turns + 100);
  b10 = EACH(w[240]) * LOAD(passed + 208) + EACH(w[244]) * LOAD(passed + 212) + EACH(w[248]) * LOAD(passed + 216);
  b10 = b10 + EACH(w[360]) * LOAD(turns + 76) + EACH(w[380]) * LOAD(turns + 116);
  b7 = b12 + b10;
  b4 = EACH(w[205]) * LOAD(turns + 64);
  b4 = EACH(w[85]) * LOAD(passed + 220) + EACH(w[89]) * LOAD(passed + 224) + EACH(w[93]) * LOAD(passed + 228) + b4;
  b4 = b4 + EACH(w[225]) * LOAD(turns + 104);
  b1 = EACH(w[207]) * LOAD(turns + 72);
  b1 = EACH(w[87]) * LOAD(passed + 232) + EACH(w[91]) * LOAD(passed + 236) + EACH(w[95]) * LOAD(passed + 240) + b1;
  b1 = b1 + EACH(w[227]) * LOAD(turns + 112);
  b2 = b4 + b1;
  b9 = EACH(w[86]) * LOAD(passed + 244) + EACH(w[90]) * b0 + EACH(w[94]) * b3 + EACH(w[206]) * LOAD(turns + 68);
  b9 = b9 + EACH(w[226]) * LOAD(turns + 108);
  b8 = EACH((-11.451515875011848)) * b7 + EACH((-29.980457783490014)) * b2 + EACH((-37.05788381695633)) * b9;
  STORE(passed + 300, b8);
  b10 = b12 - b10;
  b1 = b4 - b1;
  b4 = EACH(w[120]) * LOAD(passed + 196) + EACH(w[124]) * LOAD(passed + 200) + EACH(w[128]) * LOAD(passed + 204);
  b4 = b4 + EACH(w[180]) * LOAD(turns + 0) + EACH(w[200]) * LOAD(turns + 40);
  b12 = EACH(w[276]) * LOAD(passed + 208) + EACH(w[280]) * LOAD(passed + 212) + EACH(w[284]) * LOAD(passed + 216);
  b12 = b12 + EACH(w[336]) * LOAD(turns + 16) + EACH(w[356]) * LOAD(turns + 56);
  b8 = b4 + b12;
  b6 = EACH(w[121]) * LOAD(passed + 220) + EACH(w[125]) * LOAD(passed + 224) + EACH(w[129]) * LOAD(passed + 228);
  b6 = b6 + EACH(w[181]) * LOAD(turns + 4) + EACH(w[201]) * LOAD(turns + 44);
  b5 = EACH(w[123]) * LOAD(passed + 232) + EACH(w[127]) * LOAD(passed + 236) + EACH(w[131]) * LOAD(passed + 240);
  b5 = b5 + EACH(w[183]) * LOAD(turns + 12) + EACH(w[203]) * LOAD(turns + 52);
  b11 = b6 + b5;
  b13 = EACH((-14.990228891745012)) * b11;
  b3 = EACH(w[122]) * LOAD(passed + 244) + EACH(w[126]) * b0 + EACH(w[130]) * b3 + EACH(w[182]) * LOAD(turns + 8);
  b3 = b3 + EACH(w[202]) * LOAD(turns + 48);
  b13 = EACH(10.357993414625463) * b10 + EACH(16.759585400111586) * b1 + EACH((-2.1870449207727667)) * b8 + b13;
  STORE(passed + 304, b13 + EACH((-22.903031750023718)) * b3);
  b12 = EACH(5.934602143709016) * (b4 - b12);
  b5 = EACH(25.139378100167388) * (b6 - b5);
  b9 = EACH(16.759585400111586) * b9;
  b9 = EACH((-8.379792700055793)) * b7 + EACH((-2.0314756838908778e-15)) * b2 + b12 + b5 + b9;
  STORE(passed + 308, b9);
  b11 = EACH((-14.053339586010956)) * b11;
  b11 = EACH(5.884745025948962) * b10 + EACH((-9.427266787562763)) * b1 + EACH((-10.16909205552639)) * b8 + b11;
  STORE(passed + 312, b11 + EACH(31.073980243876413) * b3);
  b3 = EACH(w[208]) * LOAD(turns + 60);
  b3 = EACH(w[96]) * LOAD(passed + 196) + EACH(w[100]) * LOAD(passed + 200) + EACH(w[104]) * LOAD(passed + 204) + b3;
  b11 = EACH(w[252]) * LOAD(passed + 208) + EACH(w[256]) * LOAD(passed + 212) + EACH(w[260]) * LOAD(passed + 216);
  b11 = b11 + EACH(w[364]) * LOAD(turns + 76) + EACH(w[372]) * LOAD(turns + 96);
  STORE(passed + 260, EACH((-13.97835654127895)) * (b3 + EACH(w[216]) * LOAD(turns + 80) + b11));
  b11 = EACH(w[97]) * LOAD(passed + 220) + EACH(w[101]) * LOAD(passed + 224) + EACH(w[105]) * LOAD(passed + 228);
  STORE(passed + 256, b11);
}

static void MADE(follower_reissner_k_jacobian_columns_3)(const casadi_real *w, const casadi_real *turns,
    casadi_real *columns, casadi_real *passed) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15;
  FOUR b16, b17, b18, b19, b20, b21;
  b0 = EACH(w[211]) * LOAD(turns + 72);
  b0 = EACH(w[99]) * LOAD(passed + 232) + EACH(w[103]) * LOAD(passed + 236) + EACH(w[107]) * LOAD(passed + 240) + b0;
  b0 = b0 + EACH(w[219]) * LOAD(turns + 92);
  b0 = LOAD(passed + 256) + EACH(w[209]) * LOAD(turns + 64) + EACH(w[217]) * LOAD(turns + 84) + b0;
  b1 = EACH(w[210]) * LOAD(turns + 68);
  b1 = EACH(w[98]) * LOAD(passed + 244) + EACH(w[102]) * LOAD(passed + 264) + EACH(w[106]) * LOAD(passed + 268) + b1;
  b1 = EACH((-45.23491198130754)) * (b1 + EACH(w[218]) * LOAD(turns + 88));
  b2 = EACH(w[831]) * LOAD(passed + 12) + EACH(w[832]) * LOAD(passed + 84) + EACH(w[833]) * LOAD(passed + 16);
  b3 = EACH(w[834]) * LOAD(passed + 68) + EACH(w[835]) * LOAD(passed + 72) + EACH(w[836]) * LOAD(passed + 76);
  b4 = EACH(w[837]) * LOAD(passed + 20) + EACH(w[838]) * LOAD(passed + 24) + EACH(w[839]) * LOAD(passed + 28);
  b5 = EACH(w[840]) * LOAD(passed + 56) + EACH(w[841]) * LOAD(passed + 60) + EACH(w[842]) * LOAD(passed + 64);
  b6 = EACH(w[843]) * LOAD(passed + 40) + EACH(w[844]) * LOAD(passed + 44) + EACH(w[845]) * LOAD(passed + 48);
  b7 = EACH((-0.6546457961059221)) * (b5 + b6);
  b6 = EACH(0.20229667629284673) * (b5 - b6);
  b5 = EACH(w[846]) * LOAD(passed + 12) + EACH(w[847]) * LOAD(passed + 84) + EACH(w[848]) * LOAD(passed + 16);
  b8 = EACH(w[852]) * LOAD(passed + 20) + EACH(w[853]) * LOAD(passed + 24) + EACH(w[854]) * LOAD(passed + 28);
  b8 = EACH(w[849]) * LOAD(passed + 68) + EACH(w[850]) * LOAD(passed + 72) + EACH(w[851]) * LOAD(passed + 76) + b8;
  b9 = EACH(w[858]) * LOAD(passed + 40) + EACH(w[859]) * LOAD(passed + 44) + EACH(w[860]) * LOAD(passed + 48);
  b9 = EACH(w[855]) * LOAD(passed + 56) + EACH(w[856]) * LOAD(passed + 60) + EACH(w[857]) * LOAD(passed + 64) + b9;
  b10 = EACH(w[861]) * LOAD(passed + 12) + EACH(w[862]) * LOAD(passed + 84) + EACH(w[863]) * LOAD(passed + 16);
  b11 = EACH(w[867]) * LOAD(passed + 20) + EACH(w[868]) * LOAD(passed + 24) + EACH(w[869]) * LOAD(passed + 28);
  b11 = EACH(w[864]) * LOAD(passed + 68) + EACH(w[865]) * LOAD(passed + 72) + EACH(w[866]) * LOAD(passed + 76) + b11;
  b12 = EACH(w[873]) * LOAD(passed + 40) + EACH(w[874]) * LOAD(passed + 44) + EACH(w[875]) * LOAD(passed + 48);
  b12 = EACH(w[870]) * LOAD(passed + 56) + EACH(w[871]) * LOAD(passed + 60) + EACH(w[872]) * LOAD(passed + 64) + b12;
  b13 = EACH(w[876]) * LOAD(passed + 0) + EACH(w[877]) * LOAD(passed + 88) + EACH(w[878]) * LOAD(passed + 272);
  b14 = EACH(w[879]) * LOAD(passed + 276) + EACH(w[880]) * LOAD(passed + 92) + EACH(w[881]) * LOAD(passed + 32);
  b15 = EACH(w[882]) * LOAD(passed + 276) + EACH(w[883]) * LOAD(passed + 92) + EACH(w[884]) * LOAD(passed + 32);
  b16 = EACH(w[885]) * LOAD(passed + 280) + EACH(w[886]) * LOAD(passed + 96) + EACH(w[887]) * LOAD(passed + 52);
  b17 = EACH(w[888]) * LOAD(passed + 280) + EACH(w[889]) * LOAD(passed + 96) + EACH(w[890]) * LOAD(passed + 52);
  b18 = EACH((-0.6546457961059221)) * (b16 + b17);
  b18 = EACH((-0.6546457961059221)) * (LOAD(passed + 0) + b13) + EACH((-0.6546457961059221)) * (b14 + b15) + b18;
  b16 = EACH(0.20229667629284673) * (b17 - b16);
  b17 = EACH(w[891]) * LOAD(passed + 0) + EACH(w[892]) * LOAD(passed + 88) + EACH(w[893]) * LOAD(passed + 272);
  b19 = EACH(w[897]) * LOAD(passed + 276) + EACH(w[898]) * LOAD(passed + 92) + EACH(w[899]) * LOAD(passed + 32);
  b19 = EACH(w[894]) * LOAD(passed + 276) + EACH(w[895]) * LOAD(passed + 92) + EACH(w[896]) * LOAD(passed + 32) + b19;
  b20 = EACH(w[903]) * LOAD(passed + 280) + EACH(w[904]) * LOAD(passed + 96) + EACH(w[905]) * LOAD(passed + 52);
  b20 = EACH(w[900]) * LOAD(passed + 280) + EACH(w[901]) * LOAD(passed + 96) + EACH(w[902]) * LOAD(passed + 52) + b20;
  b20 = EACH((-0.6546457961059221)) * b20;
  b20 = EACH((-0.6546457961059221)) * (LOAD(passed + 88) + b17) + EACH((-0.6546457961059221)) * b19 + b20;
  b19 = EACH(w[906]) * LOAD(passed + 0) + EACH(w[907]) * LOAD(passed + 88) + EACH(w[908]) * LOAD(passed + 272);
  b17 = EACH(w[912]) * LOAD(passed + 276) + EACH(w[913]) * LOAD(passed + 92) + EACH(w[914]) * LOAD(passed + 32);
  b17 = EACH(w[909]) * LOAD(passed + 276) + EACH(w[910]) * LOAD(passed + 92) + EACH(w[911]) * LOAD(passed + 32) + b17;
  b21 = EACH(w[918]) * LOAD(passed + 280) + EACH(w[919]) * LOAD(passed + 96) + EACH(w[920]) * LOAD(passed + 52);
  b21 = EACH(w[915]) * LOAD(passed + 280) + EACH(w[916]) * LOAD(passed + 96) + EACH(w[917]) * LOAD(passed + 52) + b21;
  b21 = EACH((-0.35976549340188024)) * b21;
  b21 = EACH((-0.35976549340188024)) * (LOAD(passed + 272) + b19) + EACH((-0.35976549340188024)) * b17 + b21;
  STORE(columns + 0, LOAD(passed + 284));
  STORE(columns + 12, LOAD(passed + 288));
  STORE(columns + 24, LOAD(passed + 292));
  STORE(columns + 36, LOAD(passed + 296));
  STORE(columns + 48, LOAD(passed + 300));
  STORE(columns + 60, LOAD(passed + 304));
  STORE(columns + 72, LOAD(passed + 308));
  STORE(columns + 84, LOAD(passed + 312));
  STORE(columns + 96, LOAD(passed + 260) + EACH((-36.59581253193273)) * b0 + b1);
  STORE(columns + 108, EACH((-0.6546457961059221)) * b2 + EACH((-0.6546457961059221)) * (b3 + b4) + b7);
  STORE(columns + 120, EACH(0.5296195743458079) * (b3 - b4) - EACH(0.6546457961059221) * b2 + b6);
  b9 = EACH((-0.6546457961059221)) * b5 + EACH((-0.6546457961059221)) * b8 + EACH((-0.6546457961059221)) * b9;
  STORE(columns + 132, b9);
  b12 = EACH((-0.35976549340188024)) * b10 + EACH((-0.35976549340188024)) * b11 + EACH((-0.35976549340188024)) * b12;
  STORE(columns + 144, b12);
  STORE(columns + 156, EACH((-1.0)) * b18);
  b16 = EACH(0.6546457961059221) * (b13 - LOAD(passed + 0)) + EACH(0.5296195743458079) * (b15 - b14) + b16;
  STORE(columns + 168, b16);
  STORE(columns + 180, EACH((-1.0)) * b20);
  STORE(columns + 192, EACH((-1.0)) * b21);
}

static void MADE(follower_reissner_k_jacobian_columns)(const casadi_real *w, const casadi_real *turns, casadi_real *columns,
    casadi_real *passed, int groups) {
  int group;
  for (group = 0; group < groups; group++, turns += 120, columns += 4) {
    EVERY_LANE(MADE(follower_reissner_k_jacobian_columns_0)(w, turns + lane, columns + lane, passed + lane))
    EVERY_LANE(MADE(follower_reissner_k_jacobian_columns_1)(w, turns + lane, columns + lane, passed + lane))
    EVERY_LANE(MADE(follower_reissner_k_jacobian_columns_2)(w, turns + lane, columns + lane, passed + lane))
    EVERY_LANE(MADE(follower_reissner_k_jacobian_columns_3)(w, turns + lane, columns + lane, passed + lane))
  }
}

static void MADE(follower_reissner_k_jacobian_part_0)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15;
  casadi_real a16, a17, a18, a19, a20, a21, a22, a23, a24, a25, a26, a27, a28, a29, a30, a31;
  casadi_real a32, a33, a34;
  a0 = arg[0] ? arg[0][0] : 0.0;
  a1 = arg[0] ? arg[0][2] : 0.0;
  a2 = 0.07822968724235527 * a0 + 0.05724557073807124 * a1;
  a3 = arg[0] ? arg[0][1] : 0.0;
  a4 = arg[0] ? arg[0][3] : 0.0;
  a5 = (-0.07075941684302883) * a3 + (-0.04020094526398382) * a4;
  a6 = a2 + a5;
  w[1481] = a6;
  a7 = arg[0] ? arg[0][4] : 0.0;
  a8 = arg[0] ? arg[0][6] : 0.0;
  a9 = 0.07822968724235527 * a7 + 0.05724557073807124 * a8;
  a10 = arg[0] ? arg[0][5] : 0.0;
  a11 = arg[0] ? arg[0][7] : 0.0;
  a12 = (-0.07075941684302883) * a10 + (-0.04020094526398382) * a11;
  a13 = a9 + a12;
  w[1482] = a13;
  a14 = arg[0] ? arg[0][8] : 0.0;
  a15 = 0.09549150281252627 * a14;
  w[1483] = a15;
  a16 = (-0.040541538314872845) * a1;
  a17 = 0.01494054079865284 * a3 + 0.06946895936968922 * a4;
  a18 = a16 + a17;
  w[1484] = a18;
  a19 = (-0.040541538314872845) * a8;
  a20 = 0.01494054079865284 * a10 + 0.06946895936968922 * a11;
  a21 = a19 + a20;
  w[1485] = a21;
  a22 = 0.20480798012976015 * a0 + 1.3877787807814457e-17 * a1;
  a23 = (-0.11449114147614248) * a3 + 0.06440126708033012 * a4;
  a24 = a22 + a23;
  w[1489] = a24;
  a25 = 0.20480798012976015 * a7 + 1.3877787807814457e-17 * a8;
  a26 = (-0.11449114147614248) * a10 + 0.06440126708033012 * a11;
  a27 = a25 + a26;
  w[1490] = a27;
  a28 = 0.25000000000000006 * a14;
  w[1491] = a28;
  a29 = (-0.17173671221421377) * a1;
  a30 = 0.1024039900648801 * a3 + 0.09600374068582515 * a4;
  a31 = a29 + a30;
  w[1492] = a31;
  a32 = (-0.17173671221421377) * a8;
  a33 = 0.1024039900648801 * a10 + 0.09600374068582515 * a11;
  a34 = a32 + a33;
  w[1493] = a34;
  a1 = 0.2531565857748097 * a0 + (-0.11449114147614246) * a1;
  w[1506] = a1;
  a8 = 0.2531565857748097 * a7 + (-0.11449114147614246) * a8;
  w[1507] = a8;
  a14 = 0.30901699437494745 * a14;
  w[1508] = a14;
  a4 = 0.15645937448471067 * a3 + (-0.21227825052908667) * a4;
  w[1509] = a4;
  a11 = 0.15645937448471067 * a10 + (-0.21227825052908667) * a11;
  w[1510] = a11;
  a23 = a22 - a23;
  w[1523] = a23;
  a26 = a25 - a26;
  w[1524] = a26;
  a29 = a30 - a29;
  w[1525] = a29;
  a32 = a33 - a32;
  w[1526] = a32;
  a5 = a2 - a5;
  w[1539] = a5;
  a12 = a9 - a12;
  w[1540] = a12;
  a16 = a17 - a16;
  w[1541] = a16;
  a19 = a20 - a19;
  w[1542] = a19;
  w[384] = a6;
  w[388] = a13;
  w[392] = a15;
  w[396] = a18;
  w[400] = a21;
  w[404] = 0.0;
  w[385] = a24;
  w[389] = a27;
  w[393] = a28;
  w[397] = a31;
  w[401] = a34;
  w[405] = 0.0;
  w[386] = a1;
  w[390] = a8;
  w[394] = a14;
  w[398] = a4;
  w[402] = a11;
  w[406] = 0.0;
  w[387] = a23;
  w[391] = a26;
  w[395] = a28;
  w[399] = a29;
  w[403] = a32;
  w[407] = 0.0;
  w[408] = a5;
  w[412] = a12;
  w[416] = a15;
  w[420] = a16;
  w[424] = a19;
  w[428] = 0.0;
  w[409] = a5;
  w[413] = a12;
  w[417] = a15;
  w[421] = a16;
  w[425] = a19;
  w[429] = 0.0;
  w[410] = a5;
  w[414] = a12;
  w[418] = a15;
  w[422] = a16;
  w[426] = a19;
  w[430] = 0.0;
  w[411] = a5;
  w[415] = a12;
  w[419] = a15;
  w[423] = a16;
  w[427] = a19;
  w[431] = 0.0;
  MADE(follower_reissner_kernels_increments)(w + 384, w + 0, 2);
  a19 = w[0] * w[1] - w[4] * w[5] - w[8] * w[9] - w[12] * w[13];
  w[1459] = a19;
  a16 = w[0] * w[5] + w[4] * w[1] + w[8] * w[13] - w[12] * w[9];
  w[1457] = a16;
  a15 = w[0] * w[9] - w[4] * w[13] + w[8] * w[1] + w[12] * w[5];
  w[1458] = a15;
  a12 = w[0] * w[13] + w[4] * w[9] - w[8] * w[5] + w[12] * w[1];
  w[1460] = a12;
  a5 = a19 * w[2] - a16 * w[6] - a15 * w[10] - a12 * w[14];
  w[1455] = a5;
  a32 = a19 * w[6] + a16 * w[2] + a15 * w[14] - a12 * w[10];
  w[1453] = a32;
  a29 = a19 * w[10] - a16 * w[14] + a15 * w[2] + a12 * w[6];
  w[1454] = a29;
  a12 = a19 * w[14] + a16 * w[10] - a15 * w[6] + a12 * w[2];
  w[1456] = a12;
  a15 = a5 * w[3] - a32 * w[7] - a29 * w[11] - a12 * w[15];
  w[1445] = a15;
  a16 = a5 * w[7] + a32 * w[3] + a29 * w[15] - a12 * w[11];
  w[1443] = a16;
  a19 = a5 * w[11] - a32 * w[15] + a29 * w[3] + a12 * w[7];
  w[1444] = a19;
  a12 = a5 * w[15] + a32 * w[11] - a29 * w[7] + a12 * w[3];
  w[1446] = a12;
  a29 = a15 * w[40] + a16 * w[36] + a19 * w[48] - a12 * w[44];
  a32 = 2.0 * a29;
  a5 = a15 * w[44] - a16 * w[48] + a19 * w[36] + a12 * w[40];
  a28 = a32 * a5;
  a26 = 2.0 * (a15 * w[36] - a16 * w[40] - a19 * w[44] - a12 * w[48]);
  a12 = a15 * w[48] + a16 * w[44] - a19 * w[40] + a12 * w[36];
  a19 = a26 * a12;
  a16 = a28 + a19;
  w[1470] = a16;
  w[877] = a16;
  a15 = 0.01788854381999832 * (arg[0] ? arg[0][9] : 0.0);
  w[1448] = a15;
  a23 = arg[0] ? arg[0][10] : 0.0;
  w[1447] = a23;
  a23 = 0.25 * (a15 - (-0.01788854381999832) * a23);
  w[1468] = a23;
  a15 = 1.0 - a32 * a29;
  a11 = 2.0 * a12 * a12;
  a4 = a15 - a11;
  w[1472] = a4;
  w[892] = a4;
  a14 = 0.00447213595499958 * (arg[0] ? arg[0][11] : 0.0);
  w[1449] = a14;
  a8 = 2.0 * a5;
  a1 = a8 * a12;
  a29 = a26 * a29;
  a34 = a1 - a29;
  w[1474] = a34;
  w[907] = a34;
  a31 = 0.25 * (1.0 + 0.009830783046228487 * (arg[0] ? arg[0][12] : 0.0));
  w[1450] = a31;
  a27 = a16 * a23 + a4 * a14 + a34 * a31;
  w[1477] = a27;
  w[665] = a27;
  a12 = a32 * a12;
  a26 = a26 * a5;
  a32 = a12 - a26;
  w[1478] = a32;
  w[878] = a32;
  a24 = arg[2] ? arg[2][0] : 0.0;
  a21 = a24 * (arg[1] ? arg[1][0] : 0.0);
  w[1462] = a21;
  a29 = a1 + a29;
  w[1479] = a29;
  w[893] = a29;
  a1 = a24 * (arg[1] ? arg[1][1] : 0.0);
  w[1464] = a1;
  a5 = a8 * a5;
  a15 = a15 - a5;
  w[1480] = a15;
  w[908] = a15;
  a8 = a24 * (arg[1] ? arg[1][2] : 0.0);
  w[1466] = a8;
  a18 = a32 * a21 + a29 * a1 + a15 * a8;
  w[1451] = a18;
  w[661] = a18;
  a18 = 0.019999999999999993 * a18;
  w[1469] = a18;
  a31 = a32 * a23 + a29 * a14 + a15 * a31;
  w[1467] = a31;
  w[663] = a31;
  a8 = a16 * a21 + a4 * a1 + a34 * a8;
  w[1452] = a8;
  w[664] = a8;
  a8 = 0.019999999999999993 * a8;
  w[1476] = a8;
  w[1441] = a27 * a18 - a31 * a8;
  a11 = 1.0 - a5 - a11;
  w[1461] = a11;
  w[876] = a11;
  a5 = a24 * (arg[1] ? arg[1][3] : 0.0);
  w[1471] = a5;
  a19 = a28 - a19;
  w[1463] = a19;
  w[891] = a19;
  a28 = a24 * (arg[1] ? arg[1][4] : 0.0);
  w[1473] = a28;
  a26 = a12 + a26;
  w[1465] = a26;
  w[906] = a26;
  a24 = a24 * (arg[1] ? arg[1][5] : 0.0);
  w[1475] = a24;
  a24 = a11 * a5 + a19 * a28 + a26 * a24;
  w[1442] = a24;
  w[695] = a24;
}

static void MADE(follower_reissner_k_jacobian_part_1)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15;
  casadi_real a16, a17, a18, a19, a20, a21, a22, a23, a24, a25, a26, a27, a28, a29, a30, a31;
  casadi_real a32, a33, a34, a35, a36, a37, a38, a39, a40, a41, a42, a43, a44;
  a0 = w[1441] + w[1442];
  w[1552] = a0;
  w[740] = a0;
  a1 = 2.0 * w[1443];
  a2 = a1 * w[1444];
  a3 = 2.0 * w[1445];
  a4 = a3 * w[1446];
  a5 = a2 + a4;
  w[1544] = a5;
  w[883] = a5;
  a6 = (-0.014472135954999582) * w[1447];
  a7 = 0.25 * (w[1448] - a6);
  a8 = 1.0 - a1 * w[1443];
  a9 = 2.0 * w[1446] * w[1446];
  a10 = a8 - a9;
  w[1547] = a10;
  w[898] = a10;
  a11 = 2.0 * w[1444];
  a12 = a11 * w[1446];
  a13 = a3 * w[1443];
  a14 = a12 - a13;
  w[1550] = a14;
  w[913] = a14;
  a14 = a5 * a7 + a10 * w[1449] + a14 * w[1450];
  w[1560] = a14;
  w[672] = a14;
  a10 = 0.1803715206000056 * w[1451];
  w[1558] = a10;
  a1 = a1 * w[1446];
  a3 = a3 * w[1444];
  a5 = a1 - a3;
  w[1545] = a5;
  w[884] = a5;
  a13 = a12 + a13;
  w[1548] = a13;
  w[899] = a13;
  a11 = a11 * w[1444];
  a8 = a8 - a11;
  w[1551] = a8;
  w[914] = a8;
  a8 = a5 * a7 + a13 * w[1449] + a8 * w[1450];
  w[1559] = a8;
  w[671] = a8;
  a13 = 0.1803715206000056 * w[1452];
  w[1556] = a13;
  a0 = a0 + (a14 * a10 - a8 * a13);
  w[1536] = a0;
  w[768] = a0;
  a5 = 2.0 * w[1453];
  a12 = a5 * w[1454];
  a15 = 2.0 * w[1455];
  a16 = a15 * w[1456];
  a17 = a12 + a16;
  w[1528] = a17;
  w[889] = a17;
  a18 = (-0.005527864045000421) * w[1447];
  a19 = 0.25 * (w[1448] - a18);
  a20 = 1.0 - a5 * w[1453];
  a21 = 2.0 * w[1456] * w[1456];
  a22 = a20 - a21;
  w[1531] = a22;
  w[904] = a22;
  a23 = 2.0 * w[1454];
  a24 = a23 * w[1456];
  a25 = a15 * w[1453];
  a26 = a24 - a25;
  w[1534] = a26;
  w[919] = a26;
  a26 = a17 * a19 + a22 * w[1449] + a26 * w[1450];
  w[1565] = a26;
  w[677] = a26;
  a22 = 0.29962847939999443 * w[1451];
  w[1563] = a22;
  a5 = a5 * w[1456];
  a15 = a15 * w[1454];
  a17 = a5 - a15;
  w[1529] = a17;
  w[890] = a17;
  a25 = a24 + a25;
  w[1532] = a25;
  w[905] = a25;
  a23 = a23 * w[1454];
  a20 = a20 - a23;
  w[1535] = a20;
  w[920] = a20;
  a20 = a17 * a19 + a25 * w[1449] + a20 * w[1450];
  w[1564] = a20;
  w[676] = a20;
  a25 = 0.29962847939999443 * w[1452];
  w[1561] = a25;
  a0 = a0 + (a26 * a22 - a20 * a25);
  w[1520] = a0;
  w[782] = a0;
  a17 = 2.0 * w[1457];
  a24 = a17 * w[1458];
  a27 = 2.0 * w[1459];
  a28 = a27 * w[1460];
  a29 = a24 + a28;
  w[1512] = a29;
  w[886] = a29;
  a18 = 0.25 * (w[1448] + a18);
  a30 = 1.0 - a17 * w[1457];
  a31 = 2.0 * w[1460] * w[1460];
  a32 = a30 - a31;
  w[1515] = a32;
  w[901] = a32;
  a33 = 2.0 * w[1458];
  a34 = a33 * w[1460];
  a35 = a27 * w[1457];
  a36 = a34 - a35;
  w[1518] = a36;
  w[916] = a36;
  a36 = a29 * a18 + a32 * w[1449] + a36 * w[1450];
  w[1568] = a36;
  w[682] = a36;
  a17 = a17 * w[1460];
  a27 = a27 * w[1458];
  a32 = a17 - a27;
  w[1513] = a32;
  w[887] = a32;
  a35 = a34 + a35;
  w[1516] = a35;
  w[902] = a35;
  a33 = a33 * w[1458];
  a30 = a30 - a33;
  w[1519] = a30;
  w[917] = a30;
  a30 = a32 * a18 + a35 * w[1449] + a30 * w[1450];
  w[1567] = a30;
  w[681] = a30;
  a0 = a0 + (a36 * a22 - a30 * a25);
  w[1503] = a0;
  w[754] = a0;
  a35 = 2.0 * w[4];
  a32 = a35 * w[8];
  a34 = 2.0 * w[0];
  a29 = a34 * w[12];
  a37 = a32 + a29;
  w[1495] = a37;
  w[880] = a37;
  a6 = 0.25 * (w[1448] + a6);
  a38 = 1.0 - a35 * w[4];
  a39 = 2.0 * w[12] * w[12];
  a40 = a38 - a39;
  w[1498] = a40;
  w[895] = a40;
  a41 = 2.0 * w[8];
  a42 = a41 * w[12];
  a43 = a34 * w[4];
  a44 = a42 - a43;
  w[1501] = a44;
  w[910] = a44;
  a44 = a37 * a6 + a40 * w[1449] + a44 * w[1450];
  w[1571] = a44;
  w[687] = a44;
  a35 = a35 * w[12];
  a34 = a34 * w[8];
  a40 = a35 - a34;
  w[1496] = a40;
  w[881] = a40;
  a43 = a42 + a43;
  w[1499] = a43;
  w[896] = a43;
  a41 = a41 * w[8];
  a38 = a38 - a41;
  w[1502] = a38;
  w[911] = a38;
  a38 = a40 * a6 + a43 * w[1449] + a38 * w[1450];
  w[1570] = a38;
  w[686] = a38;
  w[1486] = a0 + (a44 * a10 - a38 * a13);
  a0 = w[1461] * w[1462] + w[1463] * w[1464] + w[1465] * w[1466];
  w[662] = a0;
  a43 = 0.019999999999999993 * a0;
  w[1572] = a43;
  a40 = w[1461] * w[1468] + w[1463] * w[1449] + w[1465] * w[1450];
  w[1555] = a40;
  w[694] = a40;
  a42 = w[1470] * w[1471] + w[1472] * w[1473] + w[1474] * w[1475];
  w[666] = a42;
  a42 = w[1467] * a43 - a40 * w[1469] + a42;
  w[1553] = a42;
  w[735] = a42;
  a37 = 0.1803715206000056 * a0;
  w[1573] = a37;
  a9 = 1.0 - a11 - a9;
  w[1543] = a9;
  w[882] = a9;
  a4 = a2 - a4;
  w[1546] = a4;
  w[897] = a4;
  a3 = a1 + a3;
  w[1549] = a3;
  w[912] = a3;
  a3 = a9 * a7 + a4 * w[1449] + a3 * w[1450];
  w[1557] = a3;
  w[699] = a3;
  a8 = a42 + (a8 * a37 - a3 * a10);
  w[1537] = a8;
  w[763] = a8;
  a0 = 0.29962847939999443 * a0;
  w[1574] = a0;
  a21 = 1.0 - a23 - a21;
  w[1527] = a21;
  w[888] = a21;
  a16 = a12 - a16;
  w[1530] = a16;
  w[903] = a16;
  a15 = a5 + a15;
  w[1533] = a15;
  w[918] = a15;
  a15 = a21 * a19 + a16 * w[1449] + a15 * w[1450];
  w[1562] = a15;
  w[703] = a15;
  a20 = a8 + (a20 * a0 - a15 * a22);
  w[1521] = a20;
  w[777] = a20;
  a31 = 1.0 - a33 - a31;
  w[1511] = a31;
  w[885] = a31;
  a28 = a24 - a28;
  w[1514] = a28;
  w[900] = a28;
  a27 = a17 + a27;
  w[1517] = a27;
  w[915] = a27;
  a27 = a31 * a18 + a28 * w[1449] + a27 * w[1450];
  w[1566] = a27;
  w[707] = a27;
  a22 = a20 + (a30 * a0 - a27 * a22);
  w[1504] = a22;
  w[749] = a22;
  a39 = 1.0 - a41 - a39;
  w[1494] = a39;
  w[879] = a39;
  a29 = a32 - a29;
  w[1497] = a29;
  w[894] = a29;
  a34 = a35 + a34;
  w[1500] = a34;
  w[909] = a34;
  a34 = a39 * a6 + a29 * w[1449] + a34 * w[1450];
  w[1569] = a34;
  w[711] = a34;
  w[1487] = a22 + (a38 * a37 - a34 * a10);
  a10 = w[1478] * w[1471] + w[1479] * w[1473] + w[1480] * w[1475];
  w[667] = a10;
  a10 = a40 * w[1476] - w[1477] * a43 + a10;
  w[1554] = a10;
  w[736] = a10;
  a14 = a10 + (a3 * a13 - a14 * a37);
  w[1538] = a14;
  w[764] = a14;
  a26 = a14 + (a15 * a25 - a26 * a0);
  w[1522] = a26;
  w[778] = a26;
  a0 = a26 + (a27 * a25 - a36 * a0);
  w[1505] = a0;
  w[750] = a0;
  w[1488] = a0 + (a34 * a13 - a44 * a37);
  w[384] = w[1481];
  w[388] = w[1482];
  w[392] = w[1483];
  w[396] = w[1484];
  w[400] = w[1485];
  w[404] = 0.0;
  w[408] = w[16];
  w[412] = w[20];
  w[416] = w[24];
  w[420] = w[28];
  w[424] = w[32];
  w[428] = 1.0;
  w[432] = 0.0;
  w[436] = 0.0;
  w[440] = 0.0;
  w[444] = 1.0;
  w[448] = 0.0;
  w[452] = 0.0;
  w[456] = 0.0;
  w[460] = 1.0;
}

static void MADE(follower_reissner_k_jacobian_part_2)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10;
  w[464] = w[1486];
  w[468] = w[1487];
  w[472] = w[1488];
  w[385] = w[1489];
  w[389] = w[1490];
  w[393] = w[1491];
  w[397] = w[1492];
  w[401] = w[1493];
  w[405] = 0.0;
  w[409] = w[17];
  w[413] = w[21];
  w[417] = w[25];
  w[421] = w[29];
  w[425] = w[33];
  w[429] = w[1494];
  w[433] = w[1495];
  w[437] = w[1496];
  w[441] = w[1497];
  w[445] = w[1498];
  w[449] = w[1499];
  w[453] = w[1500];
  w[457] = w[1501];
  w[461] = w[1502];
  w[465] = w[1503];
  w[469] = w[1504];
  w[473] = w[1505];
  w[386] = w[1506];
  w[390] = w[1507];
  w[394] = w[1508];
  w[398] = w[1509];
  w[402] = w[1510];
  w[406] = 0.0;
  w[410] = w[18];
  w[414] = w[22];
  w[418] = w[26];
  w[422] = w[30];
  w[426] = w[34];
  w[430] = w[1511];
  w[434] = w[1512];
  w[438] = w[1513];
  w[442] = w[1514];
  w[446] = w[1515];
  w[450] = w[1516];
  w[454] = w[1517];
  w[458] = w[1518];
  w[462] = w[1519];
  w[466] = w[1520];
  w[470] = w[1521];
  w[474] = w[1522];
  w[387] = w[1523];
  w[391] = w[1524];
  w[395] = w[1491];
  w[399] = w[1525];
  w[403] = w[1526];
  w[407] = 0.0;
  w[411] = w[19];
  w[415] = w[23];
  w[419] = w[27];
  w[423] = w[31];
  w[427] = w[35];
  w[431] = w[1527];
  w[435] = w[1528];
  w[439] = w[1529];
  w[443] = w[1530];
  w[447] = w[1531];
  w[451] = w[1532];
  w[455] = w[1533];
  w[459] = w[1534];
  w[463] = w[1535];
  w[467] = w[1536];
  w[471] = w[1537];
  w[475] = w[1538];
  w[476] = w[1539];
  w[480] = w[1540];
  w[484] = w[1483];
  w[488] = w[1541];
  w[492] = w[1542];
  w[496] = 0.0;
  w[500] = w[52];
  w[504] = w[56];
  w[508] = w[60];
  w[512] = w[64];
  w[516] = w[68];
  w[520] = w[1543];
  w[524] = w[1544];
  w[528] = w[1545];
  w[532] = w[1546];
  w[536] = w[1547];
  w[540] = w[1548];
  w[544] = w[1549];
  w[548] = w[1550];
  w[552] = w[1551];
  w[556] = w[1552];
  w[560] = w[1553];
  w[564] = w[1554];
  w[477] = w[1539];
  w[481] = w[1540];
  w[485] = w[1483];
  w[489] = w[1541];
  w[493] = w[1542];
  w[497] = 0.0;
  w[501] = w[52];
  w[505] = w[56];
  w[509] = w[60];
  w[513] = w[64];
  w[517] = w[68];
  w[521] = w[1543];
  w[525] = w[1544];
  w[529] = w[1545];
  w[533] = w[1546];
  w[537] = w[1547];
  w[541] = w[1548];
  w[545] = w[1549];
  w[549] = w[1550];
  w[553] = w[1551];
  w[557] = w[1552];
  w[561] = w[1553];
  w[565] = w[1554];
  w[478] = w[1539];
  w[482] = w[1540];
  w[486] = w[1483];
  w[490] = w[1541];
  w[494] = w[1542];
  w[498] = 0.0;
  w[502] = w[52];
  w[506] = w[56];
  w[510] = w[60];
  w[514] = w[64];
  w[518] = w[68];
  w[522] = w[1543];
  w[526] = w[1544];
  w[530] = w[1545];
  w[534] = w[1546];
  w[538] = w[1547];
  w[542] = w[1548];
  w[546] = w[1549];
  w[550] = w[1550];
  w[554] = w[1551];
  w[558] = w[1552];
  w[562] = w[1553];
  w[566] = w[1554];
  w[479] = w[1539];
  w[483] = w[1540];
  w[487] = w[1483];
  w[491] = w[1541];
  w[495] = w[1542];
  w[499] = 0.0;
  w[503] = w[52];
  w[507] = w[56];
  w[511] = w[60];
  w[515] = w[64];
  w[519] = w[68];
  w[523] = w[1543];
  w[527] = w[1544];
  w[531] = w[1545];
  w[535] = w[1546];
  w[539] = w[1547];
  w[543] = w[1548];
  w[547] = w[1549];
  w[551] = w[1550];
  w[555] = w[1551];
  w[559] = w[1552];
  w[563] = w[1553];
  w[567] = w[1554];
  MADE(follower_reissner_kernels_variations)(w + 384, w + 72, 2);
  w[598] = w[1476] * w[1555];
  a0 = w[1469] * w[1467];
  a1 = w[1476] * w[1477];
  w[629] = a0 + a1;
  w[660] = w[1469] * w[1555];
  w[668] = w[1556] * w[1557];
  a2 = w[1558] * w[1559];
  a3 = w[1556] * w[1560];
  w[669] = a2 + a3;
  w[670] = w[1558] * w[1557];
  w[673] = w[1561] * w[1562];
  a4 = w[1563] * w[1564];
  a5 = w[1561] * w[1565];
  w[674] = a4 + a5;
  w[675] = w[1563] * w[1562];
  w[678] = w[1561] * w[1566];
  a6 = w[1563] * w[1567];
  a7 = w[1561] * w[1568];
  w[679] = a6 + a7;
  w[680] = w[1563] * w[1566];
  w[683] = w[1556] * w[1569];
  a8 = w[1558] * w[1570];
  a9 = w[1556] * w[1571];
  w[684] = a8 + a9;
  w[685] = w[1558] * w[1569];
  w[691] = w[1572] * w[1477];
  a10 = w[1572] * w[1555];
  w[692] = a0 + a10;
  w[693] = w[1469] * w[1477];
  w[696] = w[1573] * w[1560];
  a0 = w[1573] * w[1557];
  w[697] = a2 + a0;
  w[698] = w[1558] * w[1560];
  w[700] = w[1574] * w[1565];
  a2 = w[1574] * w[1562];
  w[701] = a4 + a2;
  w[702] = w[1563] * w[1565];
  w[704] = w[1574] * w[1568];
  a4 = w[1574] * w[1566];
  w[705] = a6 + a4;
  w[706] = w[1563] * w[1568];
  w[708] = w[1573] * w[1571];
  a6 = w[1573] * w[1569];
  w[709] = a8 + a6;
  w[710] = w[1558] * w[1571];
  w[715] = w[1572] * w[1467];
  w[716] = w[1476] * w[1467];
  w[717] = a1 + a10;
  w[718] = w[1573] * w[1559];
  w[719] = w[1556] * w[1559];
  w[720] = a3 + a0;
  w[721] = w[1574] * w[1564];
  w[722] = w[1561] * w[1564];
  w[723] = a5 + a2;
  w[724] = w[1574] * w[1567];
  w[725] = w[1561] * w[1567];
  w[726] = a7 + a4;
  w[727] = w[1573] * w[1570];
  w[728] = w[1556] * w[1570];
  w[729] = a9 + a6;
  w[831] = w[1470] * w[1469] - w[1478] * w[1476];
  w[832] = w[1478] * w[1572] - w[1461] * w[1469];
  w[833] = w[1461] * w[1476] - w[1470] * w[1572];
  w[834] = w[1495] * w[1558] - w[1496] * w[1556];
  w[835] = w[1496] * w[1573] - w[1494] * w[1558];
  w[836] = w[1494] * w[1556] - w[1495] * w[1573];
  w[837] = w[1544] * w[1558] - w[1545] * w[1556];
  w[838] = w[1545] * w[1573] - w[1543] * w[1558];
  w[839] = w[1543] * w[1556] - w[1544] * w[1573];
  w[840] = w[1512] * w[1563] - w[1513] * w[1561];
  w[841] = w[1513] * w[1574] - w[1511] * w[1563];
  w[842] = w[1511] * w[1561] - w[1512] * w[1574];
  w[843] = w[1528] * w[1563] - w[1529] * w[1561];
  w[844] = w[1529] * w[1574] - w[1527] * w[1563];
  w[845] = w[1527] * w[1561] - w[1528] * w[1574];
  w[846] = w[1472] * w[1469] - w[1479] * w[1476];
}

static void MADE(follower_reissner_k_jacobian_part_3)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  w[847] = w[1479] * w[1572] - w[1463] * w[1469];
  w[848] = w[1463] * w[1476] - w[1472] * w[1572];
  w[849] = w[1498] * w[1558] - w[1499] * w[1556];
  w[850] = w[1499] * w[1573] - w[1497] * w[1558];
  w[851] = w[1497] * w[1556] - w[1498] * w[1573];
  w[852] = w[1547] * w[1558] - w[1548] * w[1556];
  w[853] = w[1548] * w[1573] - w[1546] * w[1558];
  w[854] = w[1546] * w[1556] - w[1547] * w[1573];
  w[855] = w[1515] * w[1563] - w[1516] * w[1561];
  w[856] = w[1516] * w[1574] - w[1514] * w[1563];
  w[857] = w[1514] * w[1561] - w[1515] * w[1574];
  w[858] = w[1531] * w[1563] - w[1532] * w[1561];
  w[859] = w[1532] * w[1574] - w[1530] * w[1563];
  w[860] = w[1530] * w[1561] - w[1531] * w[1574];
  w[861] = w[1474] * w[1469] - w[1480] * w[1476];
  w[862] = w[1480] * w[1572] - w[1465] * w[1469];
  w[863] = w[1465] * w[1476] - w[1474] * w[1572];
  w[864] = w[1501] * w[1558] - w[1502] * w[1556];
  w[865] = w[1502] * w[1573] - w[1500] * w[1558];
  w[866] = w[1500] * w[1556] - w[1501] * w[1573];
  w[867] = w[1550] * w[1558] - w[1551] * w[1556];
  w[868] = w[1551] * w[1573] - w[1549] * w[1558];
  w[869] = w[1549] * w[1556] - w[1550] * w[1573];
  w[870] = w[1518] * w[1563] - w[1519] * w[1561];
  w[871] = w[1519] * w[1574] - w[1517] * w[1563];
  w[872] = w[1517] * w[1561] - w[1518] * w[1574];
  w[873] = w[1534] * w[1563] - w[1535] * w[1561];
  w[874] = w[1535] * w[1574] - w[1533] * w[1563];
  w[875] = w[1533] * w[1561] - w[1534] * w[1574];
  MADE(follower_reissner_k_jacobian_columns)(w, follower_reissner_kernels_table_0 + 0, w + 921, w + 1125, 3);
  res[0][0] = 1.0 + w[921];
  res[0][1] = w[933];
  res[0][2] = w[945];
  res[0][3] = w[957];
  res[0][4] = w[969];
  res[0][5] = w[981];
  res[0][6] = w[993];
  res[0][7] = w[1005];
  res[0][8] = w[1017];
  res[0][9] = w[1029] + w[1077];
  res[0][10] = w[1041] + w[1089];
  res[0][11] = w[1053] + w[1101];
  res[0][12] = w[1065] + w[1113];
  res[0][13] = w[922];
  res[0][14] = 0.3333333333333334 + w[934];
  res[0][15] = w[946];
  res[0][16] = w[958];
  res[0][17] = w[970];
  res[0][18] = w[982];
  res[0][19] = w[994];
  res[0][20] = w[1006];
  res[0][21] = w[1018];
  res[0][22] = w[1030] + w[1078];
  res[0][23] = w[1042] + w[1090];
  res[0][24] = w[1054] + w[1102];
  res[0][25] = w[1066] + w[1114];
  res[0][26] = w[923];
  res[0][27] = w[935];
  res[0][28] = 0.19999999999999993 + w[947];
  res[0][29] = w[959];
  res[0][30] = w[971];
  res[0][31] = w[983];
  res[0][32] = w[995];
  res[0][33] = w[1007];
  res[0][34] = w[1019];
  res[0][35] = w[1031] + w[1079];
  res[0][36] = w[1043] + w[1091];
  res[0][37] = w[1055] + w[1103];
  res[0][38] = w[1067] + w[1115];
  res[0][39] = w[924];
  res[0][40] = w[936];
  res[0][41] = w[948];
  res[0][42] = 0.14285714285714257 + w[960];
  res[0][43] = w[972];
  res[0][44] = w[984];
  res[0][45] = w[996];
  res[0][46] = w[1008];
  res[0][47] = w[1020];
  res[0][48] = w[1032] + w[1080];
  res[0][49] = w[1044] + w[1092];
  res[0][50] = w[1056] + w[1104];
  res[0][51] = w[1068] + w[1116];
  res[0][52] = w[925];
  res[0][53] = w[937];
  res[0][54] = w[949];
  res[0][55] = w[961];
  res[0][56] = 1.0 + w[973];
  res[0][57] = w[985];
  res[0][58] = w[997];
  res[0][59] = w[1009];
  res[0][60] = w[1021];
  res[0][61] = w[1033] + w[1081];
  res[0][62] = w[1045] + w[1093];
  res[0][63] = w[1057] + w[1105];
  res[0][64] = w[1069] + w[1117];
  res[0][65] = w[926];
  res[0][66] = w[938];
  res[0][67] = w[950];
  res[0][68] = w[962];
  res[0][69] = w[974];
  res[0][70] = 0.3333333333333334 + w[986];
  res[0][71] = w[998];
  res[0][72] = w[1010];
  res[0][73] = w[1022];
  res[0][74] = w[1034] + w[1082];
  res[0][75] = w[1046] + w[1094];
  res[0][76] = w[1058] + w[1106];
  res[0][77] = w[1070] + w[1118];
  res[0][78] = w[927];
  res[0][79] = w[939];
  res[0][80] = w[951];
  res[0][81] = w[963];
  res[0][82] = w[975];
  res[0][83] = w[987];
  res[0][84] = 0.19999999999999993 + w[999];
  res[0][85] = w[1011];
  res[0][86] = w[1023];
  res[0][87] = w[1035] + w[1083];
  res[0][88] = w[1047] + w[1095];
  res[0][89] = w[1059] + w[1107];
  res[0][90] = w[1071] + w[1119];
  res[0][91] = w[928];
  res[0][92] = w[940];
  res[0][93] = w[952];
  res[0][94] = w[964];
  res[0][95] = w[976];
  res[0][96] = w[988];
  res[0][97] = w[1000];
  res[0][98] = 0.14285714285714257 + w[1012];
  res[0][99] = w[1024];
  res[0][100] = w[1036] + w[1084];
  res[0][101] = w[1048] + w[1096];
  res[0][102] = w[1060] + w[1108];
  res[0][103] = w[1072] + w[1120];
  res[0][104] = w[929];
  res[0][105] = w[941];
  res[0][106] = w[953];
  res[0][107] = w[965];
  res[0][108] = w[977];
  res[0][109] = w[989];
  res[0][110] = w[1001];
  res[0][111] = w[1013];
  res[0][112] = 0.9999999999999999 + w[1025];
  res[0][113] = w[1037] + w[1085];
  res[0][114] = w[1049] + w[1097];
  res[0][115] = w[1061] + w[1109];
  res[0][116] = w[1073] + w[1121];
  res[0][117] = w[1029];
  res[0][118] = w[1030];
  res[0][119] = w[1031];
  res[0][120] = w[1032];
  res[0][121] = w[1033];
  res[0][122] = w[1034];
  res[0][123] = w[1035];
  res[0][124] = w[1036];
  res[0][125] = w[1037];
  res[0][126] = 1.0;
  res[0][127] = 0.0;
  res[0][128] = 0.0;
  res[0][129] = 0.0;
  res[0][130] = w[1041];
  res[0][131] = w[1042];
  res[0][132] = w[1043];
  res[0][133] = w[1044];
  res[0][134] = w[1045];
  res[0][135] = w[1046];
  res[0][136] = w[1047];
  res[0][137] = w[1048];
  res[0][138] = w[1049];
  res[0][139] = 0.0;
  res[0][140] = 0.3333333333333334;
  res[0][141] = 0.0;
  res[0][142] = 0.0;
  res[0][143] = w[1053];
  res[0][144] = w[1054];
  res[0][145] = w[1055];
  res[0][146] = w[1056];
  res[0][147] = w[1057];
  res[0][148] = w[1058];
  res[0][149] = w[1059];
  res[0][150] = w[1060];
  res[0][151] = w[1061];
  res[0][152] = 0.0;
  res[0][153] = 0.0;
  res[0][154] = 1.0;
  res[0][155] = 0.0;
  res[0][156] = w[1065];
  res[0][157] = w[1066];
  res[0][158] = w[1067];
  res[0][159] = w[1068];
  res[0][160] = w[1069];
  res[0][161] = w[1070];
  res[0][162] = w[1071];
  res[0][163] = w[1072];
  res[0][164] = w[1073];
  res[0][165] = 0.0;
  res[0][166] = 0.0;
  res[0][167] = 0.0;
  res[0][168] = 1.0;
}

static int MADE(follower_reissner_k_jacobian)(const casadi_real **arg, casadi_real **res, casadi_real *w) {
  MADE(follower_reissner_k_jacobian_part_0)(arg, res, w);
  MADE(follower_reissner_k_jacobian_part_1)(arg, res, w);
  MADE(follower_reissner_k_jacobian_part_2)(arg, res, w);
  MADE(follower_reissner_k_jacobian_part_3)(arg, res, w);
  return 0;
}

static void MADE(follower_reissner_k_richer_balance_loop_0_turn)(casadi_real *w, int i) {
  STORE(w + 62 + i, LOAD(w + 1 + i) + LOAD(w + 14 + i));
}
static void MADE(follower_reissner_k_richer_balance_loop_0)(casadi_real *w) {
  const int last = 13 - 4;
  int i;
  for (i = 0; i < last; i += 4)
    EVERY_LANE(MADE(follower_reissner_k_richer_balance_loop_0_turn)(w, i + lane))
  EVERY_LANE(MADE(follower_reissner_k_richer_balance_loop_0_turn)(w, last + lane))
}

static void MADE(follower_reissner_k_richer_balance_loop_1_turn)(casadi_real *w, int i) {
  STORE(w + 75 + i, LOAD(follower_reissner_kernels_table_2 + i) * LOAD(w + 115 + i));
}
static void MADE(follower_reissner_k_richer_balance_loop_1)(casadi_real *w) {
  const int last = 40 - 4;
  int i;
  for (i = 0; i < last; i += 4)
    EVERY_LANE(MADE(follower_reissner_k_richer_balance_loop_1_turn)(w, i + lane))
  EVERY_LANE(MADE(follower_reissner_k_richer_balance_loop_1_turn)(w, last + lane))
}

static void MADE(follower_reissner_k_richer_balance_loop_2_turn)(casadi_real *w, int i) {
  STORE(w + 296 + i, EACH(0.25) * LOAD(w + 121 + i));
  STORE(w + 311 + i, EACH(0.25) * LOAD(w + 136 + i));
  STORE(w + 326 + i, EACH(0.25) * (EACH(1.0) + LOAD(w + 281 + i)));
}
static void MADE(follower_reissner_k_richer_balance_loop_2)(casadi_real *w) {
  const int last = 15 - 4;
  int i;
  for (i = 0; i < last; i += 4)
    EVERY_LANE(MADE(follower_reissner_k_richer_balance_loop_2_turn)(w, i + lane))
  EVERY_LANE(MADE(follower_reissner_k_richer_balance_loop_2_turn)(w, last + lane))
}

static void MADE(follower_reissner_k_richer_balance_loop_3_turn)(casadi_real *w, int i) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11;
  b0 = EACH(2.0) * LOAD(w + 764 + i);
  b1 = b0 * LOAD(w + 764 + i);
  b2 = EACH(2.0) * LOAD(w + 779 + i) * LOAD(w + 779 + i);
  b3 = EACH(1.0) - b1 - b2;
  b4 = EACH(2.0) * LOAD(w + 794 + i);
  b5 = b4 * LOAD(w + 764 + i);
  b6 = EACH(2.0) * LOAD(w + 809 + i);
  b7 = b6 * LOAD(w + 779 + i);
  b8 = b5 + b7;
  b9 = b4 * LOAD(w + 779 + i);
  b10 = b6 * LOAD(w + 764 + i);
  b11 = b9 - b10;
  b7 = b5 - b7;
  b4 = EACH(1.0) - b4 * LOAD(w + 794 + i);
  b2 = b4 - b2;
  b0 = b0 * LOAD(w + 779 + i);
  b6 = b6 * LOAD(w + 794 + i);
  b5 = b0 + b6;
  b10 = b9 + b10;
  b6 = b0 - b6;
  b1 = b4 - b1;
  STORE(w + 341 + i, b3);
  STORE(w + 356 + i, b8);
  STORE(w + 371 + i, b11);
  STORE(w + 386 + i, b7);
  STORE(w + 401 + i, b2);
  STORE(w + 416 + i, b5);
  STORE(w + 584 + i, b10);
  STORE(w + 599 + i, b6);
  STORE(w + 614 + i, b1);
  STORE(w + 629 + i, b3 * LOAD(w + 296 + i));
  STORE(w + 644 + i, b8 * LOAD(w + 296 + i));
  STORE(w + 659 + i, b11 * LOAD(w + 296 + i));
  STORE(w + 674 + i, b7 * LOAD(w + 311 + i));
  STORE(w + 689 + i, b2 * LOAD(w + 311 + i));
  STORE(w + 704 + i, b5 * LOAD(w + 311 + i));
  STORE(w + 719 + i, b10 * LOAD(w + 326 + i));
  STORE(w + 734 + i, b6 * LOAD(w + 326 + i));
  STORE(w + 749 + i, b1 * LOAD(w + 326 + i));
}
static void MADE(follower_reissner_k_richer_balance_loop_3)(casadi_real *w) {
  const int last = 15 - 4;
  int i;
  for (i = 0; i < last; i += 4)
    EVERY_LANE(MADE(follower_reissner_k_richer_balance_loop_3_turn)(w, i + lane))
  EVERY_LANE(MADE(follower_reissner_k_richer_balance_loop_3_turn)(w, last + lane))
}

static void MADE(follower_reissner_k_richer_balance_loop_4_turn)(casadi_real *w, int i) {
  STORE(w + 281 + i, LOAD(w + 629 + i) + LOAD(w + 674 + i) + LOAD(w + 719 + i));
}
static void MADE(follower_reissner_k_richer_balance_loop_4)(casadi_real *w) {
  const int last = 45 - 4;
  int i;
  for (i = 0; i < last; i += 4)
    EVERY_LANE(MADE(follower_reissner_k_richer_balance_loop_4_turn)(w, i + lane))
  EVERY_LANE(MADE(follower_reissner_k_richer_balance_loop_4_turn)(w, last + lane))
}

static void MADE(follower_reissner_k_richer_balance_loop_6_turn)(casadi_real *w, int i) {
  STORE(w + 115 + i, LOAD(w + 296 + i) * LOAD(w + 704 + i) - LOAD(w + 311 + i) * LOAD(w + 689 + i));
  STORE(w + 130 + i, LOAD(w + 311 + i) * LOAD(w + 674 + i) - LOAD(w + 281 + i) * LOAD(w + 704 + i));
  STORE(w + 326 + i, LOAD(w + 281 + i) * LOAD(w + 689 + i) - LOAD(w + 296 + i) * LOAD(w + 674 + i));
}
static void MADE(follower_reissner_k_richer_balance_loop_6)(casadi_real *w) {
  const int last = 15 - 4;
  int i;
  for (i = 0; i < last; i += 4)
    EVERY_LANE(MADE(follower_reissner_k_richer_balance_loop_6_turn)(w, i + lane))
  EVERY_LANE(MADE(follower_reissner_k_richer_balance_loop_6_turn)(w, last + lane))
}

static void MADE(follower_reissner_k_richer_balance_loop_7_turn)(casadi_real *w, int i) {
  STORE(w + 281 + i, LOAD(w + 341 + i) * LOAD(w + 674 + i));
  STORE(w + 719 + i, LOAD(w + 386 + i) * LOAD(w + 674 + i));
  STORE(w + 764 + i, LOAD(w + 584 + i) * LOAD(w + 674 + i));
}
static void MADE(follower_reissner_k_richer_balance_loop_7)(casadi_real *w) {
  const int last = 45 - 4;
  int i;
  for (i = 0; i < last; i += 4)
    EVERY_LANE(MADE(follower_reissner_k_richer_balance_loop_7_turn)(w, i + lane))
  EVERY_LANE(MADE(follower_reissner_k_richer_balance_loop_7_turn)(w, last + lane))
}

static void MADE(follower_reissner_k_richer_balance_loop_9_turn)(casadi_real *w, int i) {
  STORE(w + 121 + i, LOAD(w + 75 + i) + LOAD(w + 161 + i));
}
static void MADE(follower_reissner_k_richer_balance_loop_9)(casadi_real *w) {
  const int last = 40 - 4;
  int i;
  for (i = 0; i < last; i += 4)
    EVERY_LANE(MADE(follower_reissner_k_richer_balance_loop_9_turn)(w, i + lane))
  EVERY_LANE(MADE(follower_reissner_k_richer_balance_loop_9_turn)(w, last + lane))
}

static void MADE(follower_reissner_k_richer_balance_loop_10_turn)(casadi_real *w, int i) {
  STORE(w + 62 + i, LOAD(w + 121 + i));
}
static void MADE(follower_reissner_k_richer_balance_loop_10)(casadi_real *w) {
  const int last = 27 - 4;
  int i;
  for (i = 0; i < last; i += 4)
    EVERY_LANE(MADE(follower_reissner_k_richer_balance_loop_10_turn)(w, i + lane))
  EVERY_LANE(MADE(follower_reissner_k_richer_balance_loop_10_turn)(w, last + lane))
}

static void MADE(follower_reissner_k_richer_balance_loop_11_turn)(casadi_real *w, int i) {
  STORE(w + 62 + i, EACH((-1.0)) * LOAD(w + 89 + i));
}
static void MADE(follower_reissner_k_richer_balance_loop_11)(casadi_real *w) {
  const int last = 27 - 4;
  int i;
  for (i = 0; i < last; i += 4)
    EVERY_LANE(MADE(follower_reissner_k_richer_balance_loop_11_turn)(w, i + lane))
  EVERY_LANE(MADE(follower_reissner_k_richer_balance_loop_11_turn)(w, last + lane))
}

static void MADE(follower_reissner_k_richer_changes_loop_0_turn)(casadi_real *w, int i) {
  STORE(w + 64 + i, LOAD(w + 1 + i) + LOAD(w + 14 + i));
}
static void MADE(follower_reissner_k_richer_changes_loop_0)(casadi_real *w) {
  const int last = 13 - 4;
  int i;
  for (i = 0; i < last; i += 4)
    EVERY_LANE(MADE(follower_reissner_k_richer_changes_loop_0_turn)(w, i + lane))
  EVERY_LANE(MADE(follower_reissner_k_richer_changes_loop_0_turn)(w, last + lane))
}

static void MADE(follower_reissner_k_richer_changes_loop_2_turn)(casadi_real *w, int i) {
  STORE(w + 64 + i, EACH(0.25) * LOAD(w + 107 + i));
  STORE(w + 70 + i, EACH(0.25) * LOAD(w + 113 + i));
  STORE(w + 76 + i, EACH(0.25) * (EACH(1.0) + LOAD(w + 119 + i)));
}
static void MADE(follower_reissner_k_richer_changes_loop_2)(casadi_real *w) {
  const int last = 6 - 4;
  int i;
  for (i = 0; i < last; i += 4)
    EVERY_LANE(MADE(follower_reissner_k_richer_changes_loop_2_turn)(w, i + lane))
  EVERY_LANE(MADE(follower_reissner_k_richer_changes_loop_2_turn)(w, last + lane))
}

static void MADE(follower_reissner_k_richer_changes_loop_3_turn)(casadi_real *w, int i) {
  STORE(w + 82 + i, EACH(0.25) * LOAD(w + 131 + i));
  STORE(w + 97 + i, EACH(0.25) * LOAD(w + 146 + i));
  STORE(w + 112 + i, EACH(0.25) * (EACH(1.0) + LOAD(w + 291 + i)));
}
static void MADE(follower_reissner_k_richer_changes_loop_3)(casadi_real *w) {
  const int last = 15 - 4;
  int i;
  for (i = 0; i < last; i += 4)
    EVERY_LANE(MADE(follower_reissner_k_richer_changes_loop_3_turn)(w, i + lane))
  EVERY_LANE(MADE(follower_reissner_k_richer_changes_loop_3_turn)(w, last + lane))
}

static void MADE(follower_reissner_k_richer_changes_loop_4_turn)(casadi_real *w, int i) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8;
  b0 = EACH(2.0) * LOAD(w + 223 + i);
  b1 = b0 * LOAD(w + 223 + i);
  b2 = EACH(2.0) * LOAD(w + 229 + i) * LOAD(w + 229 + i);
  b3 = EACH(2.0) * LOAD(w + 235 + i);
  b4 = b3 * LOAD(w + 223 + i);
  b5 = EACH(2.0) * LOAD(w + 241 + i);
  b6 = b5 * LOAD(w + 229 + i);
  b7 = b3 * LOAD(w + 229 + i);
  b8 = b5 * LOAD(w + 223 + i);
  b3 = EACH(1.0) - b3 * LOAD(w + 235 + i);
  b0 = b0 * LOAD(w + 229 + i);
  b5 = b5 * LOAD(w + 235 + i);
  STORE(w + 127 + i, (EACH(1.0) - b1 - b2) * LOAD(w + 64 + i));
  STORE(w + 175 + i, (b4 + b6) * LOAD(w + 64 + i));
  STORE(w + 181 + i, (b7 - b8) * LOAD(w + 64 + i));
  STORE(w + 187 + i, (b4 - b6) * LOAD(w + 70 + i));
  STORE(w + 193 + i, (b3 - b2) * LOAD(w + 70 + i));
  STORE(w + 199 + i, (b0 + b5) * LOAD(w + 70 + i));
  STORE(w + 205 + i, (b7 + b8) * LOAD(w + 76 + i));
  STORE(w + 211 + i, (b0 - b5) * LOAD(w + 76 + i));
  STORE(w + 217 + i, (b3 - b1) * LOAD(w + 76 + i));
}
static void MADE(follower_reissner_k_richer_changes_loop_4)(casadi_real *w) {
  const int last = 6 - 4;
  int i;
  for (i = 0; i < last; i += 4)
    EVERY_LANE(MADE(follower_reissner_k_richer_changes_loop_4_turn)(w, i + lane))
  EVERY_LANE(MADE(follower_reissner_k_richer_changes_loop_4_turn)(w, last + lane))
}

static void MADE(follower_reissner_k_richer_changes_loop_5_turn)(casadi_real *w, int i) {
  STORE(w + 223 + i, LOAD(w + 241 + i) + LOAD(w + 187 + i) + LOAD(w + 205 + i));
}
static void MADE(follower_reissner_k_richer_changes_loop_5)(casadi_real *w) {
  const int last = 18 - 4;
  int i;
  for (i = 0; i < last; i += 4)
    EVERY_LANE(MADE(follower_reissner_k_richer_changes_loop_5_turn)(w, i + lane))
  EVERY_LANE(MADE(follower_reissner_k_richer_changes_loop_5_turn)(w, last + lane))
}

static void MADE(follower_reissner_k_richer_changes_loop_7_turn)(casadi_real *w, int i) {
  FOUR b0, b1, b2, b3, b4, b5, b6, b7, b8;
  b0 = EACH(2.0) * LOAD(w + 318 + i);
  b1 = b0 * LOAD(w + 318 + i);
  b2 = EACH(2.0) * LOAD(w + 333 + i) * LOAD(w + 333 + i);
  b3 = EACH(2.0) * LOAD(w + 348 + i);
  b4 = b3 * LOAD(w + 318 + i);
  b5 = EACH(2.0) * LOAD(w + 363 + i);
  b6 = b5 * LOAD(w + 333 + i);
  b7 = b3 * LOAD(w + 333 + i);
  b8 = b5 * LOAD(w + 318 + i);
  b3 = EACH(1.0) - b3 * LOAD(w + 348 + i);
  b0 = b0 * LOAD(w + 333 + i);
  b5 = b5 * LOAD(w + 348 + i);
  STORE(w + 183 + i, (EACH(1.0) - b1 - b2) * LOAD(w + 82 + i));
  STORE(w + 198 + i, (b4 + b6) * LOAD(w + 82 + i));
  STORE(w + 213 + i, (b7 - b8) * LOAD(w + 82 + i));
  STORE(w + 228 + i, (b4 - b6) * LOAD(w + 97 + i));
  STORE(w + 243 + i, (b3 - b2) * LOAD(w + 97 + i));
  STORE(w + 258 + i, (b0 + b5) * LOAD(w + 97 + i));
  STORE(w + 273 + i, (b7 + b8) * LOAD(w + 112 + i));
  STORE(w + 288 + i, (b0 - b5) * LOAD(w + 112 + i));
  STORE(w + 303 + i, (b3 - b1) * LOAD(w + 112 + i));
}
static void MADE(follower_reissner_k_richer_changes_loop_7)(casadi_real *w) {
  const int last = 15 - 4;
  int i;
  for (i = 0; i < last; i += 4)
    EVERY_LANE(MADE(follower_reissner_k_richer_changes_loop_7_turn)(w, i + lane))
  EVERY_LANE(MADE(follower_reissner_k_richer_changes_loop_7_turn)(w, last + lane))
}

static void MADE(follower_reissner_k_richer_changes_loop_9_turn)(casadi_real *w, int i) {
  STORE(w + 68 + i, LOAD(w + 183 + i) + LOAD(w + 228 + i) + LOAD(w + 273 + i));
}
static void MADE(follower_reissner_k_richer_changes_loop_9)(casadi_real *w) {
  const int last = 45 - 4;
  int i;
  for (i = 0; i < last; i += 4)
    EVERY_LANE(MADE(follower_reissner_k_richer_changes_loop_9_turn)(w, i + lane))
  EVERY_LANE(MADE(follower_reissner_k_richer_changes_loop_9_turn)(w, last + lane))
}
