#ifdef __cplusplus
extern "C" {
#endif
#ifndef casadi_real
#define casadi_real double
#endif
#ifndef casadi_int
#define casadi_int int
#endif
int six_rod_platform_k_residual_0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_residual_0_SZ_ARG 4
#define six_rod_platform_k_residual_0_SZ_RES 1
#define six_rod_platform_k_residual_0_SZ_IW 0
#define six_rod_platform_k_residual_0_SZ_W 2
int six_rod_platform_k_residual_1(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_residual_1_SZ_ARG 4
#define six_rod_platform_k_residual_1_SZ_RES 1
#define six_rod_platform_k_residual_1_SZ_IW 0
#define six_rod_platform_k_residual_1_SZ_W 544
int six_rod_platform_k_jacobian_0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_jacobian_0_SZ_ARG 4
#define six_rod_platform_k_jacobian_0_SZ_RES 1
#define six_rod_platform_k_jacobian_0_SZ_IW 0
#define six_rod_platform_k_jacobian_0_SZ_W 132
int six_rod_platform_k_jacobian_1(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_jacobian_1_SZ_ARG 4
#define six_rod_platform_k_jacobian_1_SZ_RES 1
#define six_rod_platform_k_jacobian_1_SZ_IW 0
#define six_rod_platform_k_jacobian_1_SZ_W 2531
int six_rod_platform_k_input_jacobian_0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_input_jacobian_0_SZ_ARG 4
#define six_rod_platform_k_input_jacobian_0_SZ_RES 1
#define six_rod_platform_k_input_jacobian_0_SZ_IW 0
#define six_rod_platform_k_input_jacobian_0_SZ_W 2
int six_rod_platform_k_input_jacobian_1(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_input_jacobian_1_SZ_ARG 4
#define six_rod_platform_k_input_jacobian_1_SZ_RES 1
#define six_rod_platform_k_input_jacobian_1_SZ_IW 0
#define six_rod_platform_k_input_jacobian_1_SZ_W 875
int six_rod_platform_k_rate(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_rate_SZ_ARG 5
#define six_rod_platform_k_rate_SZ_RES 1
#define six_rod_platform_k_rate_SZ_IW 0
#define six_rod_platform_k_rate_SZ_W 2052
int six_rod_platform_k_tangent(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_tangent_SZ_ARG 1
#define six_rod_platform_k_tangent_SZ_RES 1
#define six_rod_platform_k_tangent_SZ_IW 0
#define six_rod_platform_k_tangent_SZ_W 2
int six_rod_platform_k_resolution_index(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_resolution_index_SZ_ARG 2
#define six_rod_platform_k_resolution_index_SZ_RES 1
#define six_rod_platform_k_resolution_index_SZ_IW 0
#define six_rod_platform_k_resolution_index_SZ_W 555
int six_rod_platform_k_richer_balance(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_richer_balance_SZ_ARG 4
#define six_rod_platform_k_richer_balance_SZ_RES 1
#define six_rod_platform_k_richer_balance_SZ_IW 0
#define six_rod_platform_k_richer_balance_SZ_W 2524
int six_rod_platform_k_watched(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_watched_SZ_ARG 2
#define six_rod_platform_k_watched_SZ_RES 1
#define six_rod_platform_k_watched_SZ_IW 0
#define six_rod_platform_k_watched_SZ_W 704
int six_rod_platform_k_igm_leg_1(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_igm_leg_1_SZ_ARG 4
#define six_rod_platform_k_igm_leg_1_SZ_RES 3
#define six_rod_platform_k_igm_leg_1_SZ_IW 0
#define six_rod_platform_k_igm_leg_1_SZ_W 591
int six_rod_platform_k_igm_leg_2(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_igm_leg_2_SZ_ARG 4
#define six_rod_platform_k_igm_leg_2_SZ_RES 3
#define six_rod_platform_k_igm_leg_2_SZ_IW 0
#define six_rod_platform_k_igm_leg_2_SZ_W 591
int six_rod_platform_k_igm_leg_3(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_igm_leg_3_SZ_ARG 4
#define six_rod_platform_k_igm_leg_3_SZ_RES 3
#define six_rod_platform_k_igm_leg_3_SZ_IW 0
#define six_rod_platform_k_igm_leg_3_SZ_W 591
int six_rod_platform_k_igm_leg_4(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_igm_leg_4_SZ_ARG 4
#define six_rod_platform_k_igm_leg_4_SZ_RES 3
#define six_rod_platform_k_igm_leg_4_SZ_IW 0
#define six_rod_platform_k_igm_leg_4_SZ_W 591
int six_rod_platform_k_igm_leg_5(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_igm_leg_5_SZ_ARG 4
#define six_rod_platform_k_igm_leg_5_SZ_RES 3
#define six_rod_platform_k_igm_leg_5_SZ_IW 0
#define six_rod_platform_k_igm_leg_5_SZ_W 591
int six_rod_platform_k_igm_leg_6(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_igm_leg_6_SZ_ARG 4
#define six_rod_platform_k_igm_leg_6_SZ_RES 3
#define six_rod_platform_k_igm_leg_6_SZ_IW 0
#define six_rod_platform_k_igm_leg_6_SZ_W 591
int six_rod_platform_k_tip_leg_1(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_tip_leg_1_SZ_ARG 2
#define six_rod_platform_k_tip_leg_1_SZ_RES 2
#define six_rod_platform_k_tip_leg_1_SZ_IW 0
#define six_rod_platform_k_tip_leg_1_SZ_W 373
int six_rod_platform_k_tip_leg_2(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_tip_leg_2_SZ_ARG 2
#define six_rod_platform_k_tip_leg_2_SZ_RES 2
#define six_rod_platform_k_tip_leg_2_SZ_IW 0
#define six_rod_platform_k_tip_leg_2_SZ_W 373
int six_rod_platform_k_tip_leg_3(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_tip_leg_3_SZ_ARG 2
#define six_rod_platform_k_tip_leg_3_SZ_RES 2
#define six_rod_platform_k_tip_leg_3_SZ_IW 0
#define six_rod_platform_k_tip_leg_3_SZ_W 373
int six_rod_platform_k_tip_leg_4(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_tip_leg_4_SZ_ARG 2
#define six_rod_platform_k_tip_leg_4_SZ_RES 2
#define six_rod_platform_k_tip_leg_4_SZ_IW 0
#define six_rod_platform_k_tip_leg_4_SZ_W 373
int six_rod_platform_k_tip_leg_5(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_tip_leg_5_SZ_ARG 2
#define six_rod_platform_k_tip_leg_5_SZ_RES 2
#define six_rod_platform_k_tip_leg_5_SZ_IW 0
#define six_rod_platform_k_tip_leg_5_SZ_W 373
int six_rod_platform_k_tip_leg_6(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_tip_leg_6_SZ_ARG 2
#define six_rod_platform_k_tip_leg_6_SZ_RES 2
#define six_rod_platform_k_tip_leg_6_SZ_IW 0
#define six_rod_platform_k_tip_leg_6_SZ_W 373
int six_rod_platform_k_tip_jacobian_leg_1(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_tip_jacobian_leg_1_SZ_ARG 2
#define six_rod_platform_k_tip_jacobian_leg_1_SZ_RES 2
#define six_rod_platform_k_tip_jacobian_leg_1_SZ_IW 0
#define six_rod_platform_k_tip_jacobian_leg_1_SZ_W 768
int six_rod_platform_k_tip_jacobian_leg_2(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_tip_jacobian_leg_2_SZ_ARG 2
#define six_rod_platform_k_tip_jacobian_leg_2_SZ_RES 2
#define six_rod_platform_k_tip_jacobian_leg_2_SZ_IW 0
#define six_rod_platform_k_tip_jacobian_leg_2_SZ_W 768
int six_rod_platform_k_tip_jacobian_leg_3(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_tip_jacobian_leg_3_SZ_ARG 2
#define six_rod_platform_k_tip_jacobian_leg_3_SZ_RES 2
#define six_rod_platform_k_tip_jacobian_leg_3_SZ_IW 0
#define six_rod_platform_k_tip_jacobian_leg_3_SZ_W 768
int six_rod_platform_k_tip_jacobian_leg_4(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_tip_jacobian_leg_4_SZ_ARG 2
#define six_rod_platform_k_tip_jacobian_leg_4_SZ_RES 2
#define six_rod_platform_k_tip_jacobian_leg_4_SZ_IW 0
#define six_rod_platform_k_tip_jacobian_leg_4_SZ_W 768
int six_rod_platform_k_tip_jacobian_leg_5(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_tip_jacobian_leg_5_SZ_ARG 2
#define six_rod_platform_k_tip_jacobian_leg_5_SZ_RES 2
#define six_rod_platform_k_tip_jacobian_leg_5_SZ_IW 0
#define six_rod_platform_k_tip_jacobian_leg_5_SZ_W 768
int six_rod_platform_k_tip_jacobian_leg_6(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_tip_jacobian_leg_6_SZ_ARG 2
#define six_rod_platform_k_tip_jacobian_leg_6_SZ_RES 2
#define six_rod_platform_k_tip_jacobian_leg_6_SZ_IW 0
#define six_rod_platform_k_tip_jacobian_leg_6_SZ_W 768
int six_rod_platform_k_shape_leg_1(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_shape_leg_1_SZ_ARG 3
#define six_rod_platform_k_shape_leg_1_SZ_RES 2
#define six_rod_platform_k_shape_leg_1_SZ_IW 0
#define six_rod_platform_k_shape_leg_1_SZ_W 456
int six_rod_platform_k_shape_leg_2(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_shape_leg_2_SZ_ARG 3
#define six_rod_platform_k_shape_leg_2_SZ_RES 2
#define six_rod_platform_k_shape_leg_2_SZ_IW 0
#define six_rod_platform_k_shape_leg_2_SZ_W 456
int six_rod_platform_k_shape_leg_3(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_shape_leg_3_SZ_ARG 3
#define six_rod_platform_k_shape_leg_3_SZ_RES 2
#define six_rod_platform_k_shape_leg_3_SZ_IW 0
#define six_rod_platform_k_shape_leg_3_SZ_W 456
int six_rod_platform_k_shape_leg_4(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_shape_leg_4_SZ_ARG 3
#define six_rod_platform_k_shape_leg_4_SZ_RES 2
#define six_rod_platform_k_shape_leg_4_SZ_IW 0
#define six_rod_platform_k_shape_leg_4_SZ_W 456
int six_rod_platform_k_shape_leg_5(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_shape_leg_5_SZ_ARG 3
#define six_rod_platform_k_shape_leg_5_SZ_RES 2
#define six_rod_platform_k_shape_leg_5_SZ_IW 0
#define six_rod_platform_k_shape_leg_5_SZ_W 456
int six_rod_platform_k_shape_leg_6(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_shape_leg_6_SZ_ARG 3
#define six_rod_platform_k_shape_leg_6_SZ_RES 2
#define six_rod_platform_k_shape_leg_6_SZ_IW 0
#define six_rod_platform_k_shape_leg_6_SZ_W 456
int six_rod_platform_k_body_platform(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_body_platform_SZ_ARG 2
#define six_rod_platform_k_body_platform_SZ_RES 2
#define six_rod_platform_k_body_platform_SZ_IW 0
#define six_rod_platform_k_body_platform_SZ_W 2
int six_rod_platform_k_body_jacobian_platform(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define six_rod_platform_k_body_jacobian_platform_SZ_ARG 2
#define six_rod_platform_k_body_jacobian_platform_SZ_RES 2
#define six_rod_platform_k_body_jacobian_platform_SZ_IW 0
#define six_rod_platform_k_body_jacobian_platform_SZ_W 2
#ifdef __cplusplus
} /* extern "C" */
#endif
