"""From a scene to named CasADi functions: the stages of the river in their order.

Scene ── rods.rod_properties ─▶ RodProperties        what each rod is made of
      ── inputs.input_layout ─▶ InputLayout          what stays free at run time
      ── mesh.discretise     ─▶ Discretisation       modes, nodes, element ends
      ── system.assemble     ─▶ System               residual, Jacobian, fields as expressions
      ── build.build         ─▶ Model                named Functions
"""
