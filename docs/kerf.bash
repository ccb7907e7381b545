# Completion of kerf for bash; `kerf keys --completion bash` prints it. Use: source kerf.bash

_kerf() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} options=
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    COMPREPLY=($(compgen -W "run solve map check validate grow optimize sweep report mesh keys init bench --help --version" -- "$word"))
    return
  fi
  case $before in
    --set)
      COMPREPLY=($(compgen -S = -W "$_kerf_keys" -- "$word"))
      compopt -o nospace
      return ;;
    -o | --output | --peers | --write) COMPREPLY=($(compgen -d -- "$word")) && return ;;
  esac
  case ${COMP_WORDS[1]} in
    run) options="--help --output --set --resume --threads --processes --untrusted --quiet --log-level --force --dry-run --max-memory --max-seconds" ;;
    solve) options="--help --output --set --threads --processes --untrusted --quiet --log-level --force --dry-run --max-memory --max-seconds" ;;
    map) options="--help --output --set --threads --processes --untrusted --quiet --log-level --force --dry-run --max-memory --max-seconds" ;;
    check) options="--help --output --set --threads --untrusted --quiet --log-level --force --max-memory --max-seconds" ;;
    validate) options="--help --output --set --threads --untrusted --quiet --log-level --force --dry-run --max-memory --max-seconds" ;;
    grow) options="--help --output --set --threads --untrusted --quiet --log-level --force --dry-run --max-memory --max-seconds" ;;
    optimize) options="--help --output --set --resume --threads --processes --untrusted --quiet --log-level --force --dry-run --max-memory --max-seconds" ;;
    sweep) options="--help --output --set --over --jobs --threads --write --max-memory --max-seconds --untrusted --collect --quiet" ;;
    report) options="--help --quiet --max-memory --max-seconds" ;;
    mesh) options="--help --output --format --set --threads --untrusted --quiet --log-level --force --max-memory --max-seconds" ;;
    keys) options="--help --markdown --schema --completion --write" ;;
    init) options="--help --list --output --force" ;;
    bench) options="--help" ;;
  esac
  if [[ $word == -* ]]; then
    COMPREPLY=($(compgen -W "$options" -- "$word"))
  elif [ "${COMP_WORDS[1]}" = keys ]; then
    COMPREPLY=($(compgen -W "$_kerf_keys" -- "$word"))
  else
    COMPREPLY=($(compgen -f -X '!*.toml' -- "$word") $(compgen -d -- "$word"))
  fi
}

_kerf_keys="
title
units.length
units.stress
domain.outline
domain.sides
domain.file
domain.side[0].near
domain.side[0].name
hole[0].name
hole[0].circle.center
hole[0].circle.radius
hole[0].ellipse.center
hole[0].ellipse.semi_axes
hole[0].ellipse.angle_deg
hole[0].polygon
hole[0].outline
hole[0].sides
crack[0].name
crack[0].path
crack[0].arc.center
crack[0].arc.radius
crack[0].arc.from_deg
crack[0].arc.to_deg
crack[0].contact
crack[0].friction
crack[0].tresca
crack[0].pressure
crack[0].gap
material.young
material.poisson
material.shear
material.angle
material.thickness
material.eigenstrain
material.state
region[0].name
region[0].circle.center
region[0].circle.radius
region[0].ellipse.center
region[0].ellipse.semi_axes
region[0].ellipse.angle_deg
region[0].polygon
region[0].outline
region[0].young
region[0].poisson
region[0].shear
region[0].angle
region[0].eigenstrain
interface[0].name
interface[0].between
interface[0].contact
interface[0].friction
interface[0].gap
boundary[0].on
boundary[0].traction
boundary[0].pressure
boundary[0].displacement
boundary[0].displacement_x
boundary[0].displacement_y
boundary[0].displacement_normal
body.force
mesh.size
mesh.crack_tip_size
mesh.min_angle
mesh.refine
mesh.curved
mesh.mesher
mesh.adapt.error
mesh.adapt.max_triangles
mesh.adapt.of
mesh.adapt.crack
mesh.adapt.tip
mesh.adapt.at
solver.element
solver.degree
solver.contact
solver.backend
solver.precision
solver.petsc
functional.kind
functional.on
functional.crack
functional.tip
functional.target
functional.direction
functional.measured
functional.p
functional.ring
functional.weight
functional.terms[0].kind
functional.terms[0].on
functional.terms[0].crack
functional.terms[0].tip
functional.terms[0].target
functional.terms[0].direction
functional.terms[0].measured
functional.terms[0].p
functional.terms[0].ring
functional.terms[0].weight
functional.terms[0].factor
map.perturbation
map.perturbation.young
map.perturbation.poisson
map.perturbation.aspect
map.points
map.bounds
map.second
map.radius
validate.points
validate.radii
validate.radii.largest
validate.radii.ratio
validate.radii.count
grow.law.kind
grow.law.K_c
grow.law.C
grow.law.m
grow.law.gamma
grow.law.threshold
grow.law.p
grow.law.q
grow.law.alpha
grow.law.flow_ratio
grow.law.dK_0
grow.law.a_0
grow.law.C_plus
grow.law.C_minus
grow.criterion
grow.tips
grow.cycle.max
grow.cycle.min
grow.cycle.file
grow.step
grow.tolerance
grow.until.length
grow.until.cycles
grow.until.K
grow.until.steps
probe[0].name
probe[0].points
probe[0].from
probe[0].to
probe[0].count
probe[0].file
probe[0].bounds
bounds.tips
bounds.points
bounds.displacements
bounds.reactions
bounds.compliance
bounds.disc[0].center
bounds.disc[0].radius
bounds.line[0].from
bounds.line[0].to
output.vtk
output.png
output.html
output.estimate
output.energy_bounds
output.tips
output.peaks
output.margins
optimize.method
optimize.volume.at_most
optimize.volume.penalty
optimize.max_iterations
optimize.tolerance
optimize.starts
optimize.bound[0].kind
optimize.bound[0].on
optimize.bound[0].crack
optimize.bound[0].tip
optimize.bound[0].target
optimize.bound[0].direction
optimize.bound[0].measured
optimize.bound[0].p
optimize.bound[0].ring
optimize.bound[0].weight
optimize.bound[0].terms[0].kind
optimize.bound[0].terms[0].on
optimize.bound[0].terms[0].crack
optimize.bound[0].terms[0].tip
optimize.bound[0].terms[0].target
optimize.bound[0].terms[0].direction
optimize.bound[0].terms[0].measured
optimize.bound[0].terms[0].p
optimize.bound[0].terms[0].ring
optimize.bound[0].terms[0].weight
optimize.bound[0].terms[0].factor
optimize.bound[0].at_most
optimize.bound[0].name
optimize.nucleate
optimize.nucleate.every
optimize.nucleate.fraction
optimize.frozen
optimize.move
optimize.inner_product
optimize.smoothing
optimize.symmetry.x
optimize.symmetry.y
optimize.symmetry.point
optimize.symmetry.direction
optimize.min_feature
optimize.min_gap
optimize.min_radius
optimize.start.holes
optimize.start.random
optimize.start.seed
optimize.start.radius
optimize.start.design
optimize.ersatz
optimize.min_distance
optimize.least_squares
optimize.least_squares.noise
optimize.defects.at_most
optimize.hole[0].name
optimize.hole[0].count
optimize.hole[0].circle.center
optimize.hole[0].circle.radius
optimize.hole[0].ellipse.center
optimize.hole[0].ellipse.semi_axes
optimize.hole[0].ellipse.angle_deg
optimize.hole[0].spline.points
optimize.hole[0].start
optimize.hole[0].start.center
optimize.hole[0].start.radius
optimize.hole[0].start.semi_axes
optimize.hole[0].start.angle_deg
optimize.hole[0].start.points
optimize.crack[0].name
optimize.crack[0].count
optimize.crack[0].path
optimize.crack[0].contact
optimize.crack[0].start
optimize.crack[0].start.path
optimize.region[0].name
optimize.region[0].count
optimize.region[0].circle.center
optimize.region[0].circle.radius
optimize.region[0].young
optimize.region[0].poisson
optimize.region[0].start
optimize.region[0].start.center
optimize.region[0].start.radius
optimize.region[0].start.young
load_case[0].name
load_case[0].weight
load_case[0].boundary[0].on
load_case[0].boundary[0].traction
load_case[0].boundary[0].pressure
load_case[0].body.force
step[0].name
step[0].substeps
synthetic.hole[0].name
synthetic.hole[0].circle.center
synthetic.hole[0].circle.radius
synthetic.hole[0].ellipse.center
synthetic.hole[0].ellipse.semi_axes
synthetic.hole[0].ellipse.angle_deg
synthetic.hole[0].polygon
synthetic.hole[0].outline
synthetic.hole[0].sides
synthetic.crack[0].name
synthetic.crack[0].path
synthetic.crack[0].arc.center
synthetic.crack[0].arc.radius
synthetic.crack[0].arc.from_deg
synthetic.crack[0].arc.to_deg
synthetic.crack[0].contact
synthetic.crack[0].friction
synthetic.crack[0].tresca
synthetic.crack[0].pressure
synthetic.crack[0].gap
synthetic.region[0].name
synthetic.region[0].circle.center
synthetic.region[0].circle.radius
synthetic.region[0].ellipse.center
synthetic.region[0].ellipse.semi_axes
synthetic.region[0].ellipse.angle_deg
synthetic.region[0].polygon
synthetic.region[0].outline
synthetic.region[0].young
synthetic.region[0].poisson
synthetic.region[0].shear
synthetic.region[0].angle
synthetic.region[0].eigenstrain
synthetic.element
synthetic.degree
synthetic.size
synthetic.crack_tip_size
synthetic.noise
synthetic.spacing
synthetic.seed
"

complete -F _kerf kerf
