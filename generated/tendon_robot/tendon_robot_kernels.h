#ifdef __cplusplus
extern "C" {
#endif
#ifndef casadi_real
#define casadi_real double
#endif
#ifndef casadi_int
#define casadi_int int
#endif
int tendon_robot_k_residual(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define tendon_robot_k_residual_SZ_ARG 3
#define tendon_robot_k_residual_SZ_RES 1
#define tendon_robot_k_residual_SZ_IW 0
#define tendon_robot_k_residual_SZ_W 739
int tendon_robot_k_jacobian(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define tendon_robot_k_jacobian_SZ_ARG 3
#define tendon_robot_k_jacobian_SZ_RES 1
#define tendon_robot_k_jacobian_SZ_IW 0
#define tendon_robot_k_jacobian_SZ_W 2418
int tendon_robot_k_rate(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define tendon_robot_k_rate_SZ_ARG 5
#define tendon_robot_k_rate_SZ_RES 1
#define tendon_robot_k_rate_SZ_IW 0
#define tendon_robot_k_rate_SZ_W 944
int tendon_robot_k_tangent(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define tendon_robot_k_tangent_SZ_ARG 1
#define tendon_robot_k_tangent_SZ_RES 1
#define tendon_robot_k_tangent_SZ_IW 0
#define tendon_robot_k_tangent_SZ_W 2
int tendon_robot_k_resolution_index(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define tendon_robot_k_resolution_index_SZ_ARG 2
#define tendon_robot_k_resolution_index_SZ_RES 1
#define tendon_robot_k_resolution_index_SZ_IW 0
#define tendon_robot_k_resolution_index_SZ_W 146
int tendon_robot_k_strain_margins(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define tendon_robot_k_strain_margins_SZ_ARG 2
#define tendon_robot_k_strain_margins_SZ_RES 1
#define tendon_robot_k_strain_margins_SZ_IW 0
#define tendon_robot_k_strain_margins_SZ_W 2
int tendon_robot_k_richer_balance(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define tendon_robot_k_richer_balance_SZ_ARG 4
#define tendon_robot_k_richer_balance_SZ_RES 1
#define tendon_robot_k_richer_balance_SZ_IW 0
#define tendon_robot_k_richer_balance_SZ_W 1605
int tendon_robot_k_watched(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define tendon_robot_k_watched_SZ_ARG 2
#define tendon_robot_k_watched_SZ_RES 1
#define tendon_robot_k_watched_SZ_IW 0
#define tendon_robot_k_watched_SZ_W 401
int tendon_robot_k_igm(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define tendon_robot_k_igm_SZ_ARG 4
#define tendon_robot_k_igm_SZ_RES 3
#define tendon_robot_k_igm_SZ_IW 0
#define tendon_robot_k_igm_SZ_W 759
int tendon_robot_k_tip(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define tendon_robot_k_tip_SZ_ARG 2
#define tendon_robot_k_tip_SZ_RES 2
#define tendon_robot_k_tip_SZ_IW 0
#define tendon_robot_k_tip_SZ_W 326
int tendon_robot_k_tip_jacobian(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define tendon_robot_k_tip_jacobian_SZ_ARG 2
#define tendon_robot_k_tip_jacobian_SZ_RES 2
#define tendon_robot_k_tip_jacobian_SZ_IW 0
#define tendon_robot_k_tip_jacobian_SZ_W 1038
int tendon_robot_k_shape(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define tendon_robot_k_shape_SZ_ARG 3
#define tendon_robot_k_shape_SZ_RES 2
#define tendon_robot_k_shape_SZ_IW 0
#define tendon_robot_k_shape_SZ_W 342
int tendon_robot_k_actuator_lower_east(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define tendon_robot_k_actuator_lower_east_SZ_ARG 2
#define tendon_robot_k_actuator_lower_east_SZ_RES 3
#define tendon_robot_k_actuator_lower_east_SZ_IW 0
#define tendon_robot_k_actuator_lower_east_SZ_W 2
int tendon_robot_k_actuator_lower_north(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define tendon_robot_k_actuator_lower_north_SZ_ARG 2
#define tendon_robot_k_actuator_lower_north_SZ_RES 3
#define tendon_robot_k_actuator_lower_north_SZ_IW 0
#define tendon_robot_k_actuator_lower_north_SZ_W 2
int tendon_robot_k_actuator_upper_west(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define tendon_robot_k_actuator_upper_west_SZ_ARG 2
#define tendon_robot_k_actuator_upper_west_SZ_RES 3
#define tendon_robot_k_actuator_upper_west_SZ_IW 0
#define tendon_robot_k_actuator_upper_west_SZ_W 2
int tendon_robot_k_actuator_upper_south(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem);
#define tendon_robot_k_actuator_upper_south_SZ_ARG 2
#define tendon_robot_k_actuator_upper_south_SZ_RES 3
#define tendon_robot_k_actuator_upper_south_SZ_IW 0
#define tendon_robot_k_actuator_upper_south_SZ_W 2
#ifdef __cplusplus
} /* extern "C" */
#endif
