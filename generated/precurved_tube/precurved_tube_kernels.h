#ifdef __cplusplus
extern "C" {
#endif
#ifndef casadi_real
#define casadi_real double
#endif
#ifndef casadi_int
#define casadi_int int
#endif
int precurved_tube_k_residual(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define precurved_tube_k_residual_SZ_ARG 3
#define precurved_tube_k_residual_SZ_RES 1
#define precurved_tube_k_residual_SZ_IW 0
#define precurved_tube_k_residual_SZ_W 579
int precurved_tube_k_jacobian(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define precurved_tube_k_jacobian_SZ_ARG 3
#define precurved_tube_k_jacobian_SZ_RES 1
#define precurved_tube_k_jacobian_SZ_IW 0
#define precurved_tube_k_jacobian_SZ_W 1780
int precurved_tube_k_rate(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define precurved_tube_k_rate_SZ_ARG 5
#define precurved_tube_k_rate_SZ_RES 1
#define precurved_tube_k_rate_SZ_IW 0
#define precurved_tube_k_rate_SZ_W 455
int precurved_tube_k_tangent(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define precurved_tube_k_tangent_SZ_ARG 1
#define precurved_tube_k_tangent_SZ_RES 1
#define precurved_tube_k_tangent_SZ_IW 0
#define precurved_tube_k_tangent_SZ_W 2
int precurved_tube_k_resolution_index(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define precurved_tube_k_resolution_index_SZ_ARG 2
#define precurved_tube_k_resolution_index_SZ_RES 1
#define precurved_tube_k_resolution_index_SZ_IW 0
#define precurved_tube_k_resolution_index_SZ_W 115
int precurved_tube_k_richer_balance(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define precurved_tube_k_richer_balance_SZ_ARG 4
#define precurved_tube_k_richer_balance_SZ_RES 1
#define precurved_tube_k_richer_balance_SZ_IW 0
#define precurved_tube_k_richer_balance_SZ_W 1026
int precurved_tube_k_watched(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define precurved_tube_k_watched_SZ_ARG 2
#define precurved_tube_k_watched_SZ_RES 1
#define precurved_tube_k_watched_SZ_IW 0
#define precurved_tube_k_watched_SZ_W 301
int precurved_tube_k_igm(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define precurved_tube_k_igm_SZ_ARG 4
#define precurved_tube_k_igm_SZ_RES 3
#define precurved_tube_k_igm_SZ_IW 0
#define precurved_tube_k_igm_SZ_W 596
int precurved_tube_k_tip(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define precurved_tube_k_tip_SZ_ARG 2
#define precurved_tube_k_tip_SZ_RES 2
#define precurved_tube_k_tip_SZ_IW 0
#define precurved_tube_k_tip_SZ_W 301
int precurved_tube_k_tip_jacobian(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define precurved_tube_k_tip_jacobian_SZ_ARG 2
#define precurved_tube_k_tip_jacobian_SZ_RES 2
#define precurved_tube_k_tip_jacobian_SZ_IW 0
#define precurved_tube_k_tip_jacobian_SZ_W 952
int precurved_tube_k_shape(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define precurved_tube_k_shape_SZ_ARG 3
#define precurved_tube_k_shape_SZ_RES 2
#define precurved_tube_k_shape_SZ_IW 0
#define precurved_tube_k_shape_SZ_W 316
#ifdef __cplusplus
} /* extern "C" */
#endif
