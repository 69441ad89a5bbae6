"""Named CasADi functions from a scene: the stages of the river in their order.

Scene ── rods.rod_properties ─▶ RodProperties        what each rod is made of
      ── inputs.input_layout ─▶ InputLayout          what stays free at run time
      ── discretise          ─▶ Discretisation       modes, nodes, element ends
      ── discrete_scene      ─▶ DiscreteScene        constant matrices, constraints, the order of the unknowns
      ── system.System       ─▶ System               rods, frames and loads as expressions
      ── equations.Equations ─▶ Equations            residual and Jacobian as expressions
      ── build.build         ─▶ Model                named Functions
"""
