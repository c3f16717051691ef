// whitted.toml for POV-Ray 3.7: z is negated (POV-Ray is left-handed), everything else is the same.
// Render and compare with `bash chapters/1-whitted/scenes/against-povray.sh`.
#version 3.7;

global_settings {
  assumed_gamma 1.0
  max_trace_level 6        // POV-Ray counts rays, we count bounces: 5 bounces are 6 rays
  adc_bailout 0.5/255      // our minimum weight
  ambient_light rgb 1
}

// The slides' 1/d²: POV-Ray's 2 / (1 + (d/f)²) for f much smaller than every d.
#declare F = 1e-4;
#macro Light(Position, Intensity)
  light_source { Position rgb Intensity/(2*F*F) fade_distance F fade_power 2 }
#end
// Local model ρ_d (N·L) + ρ_s (R·V)ⁿ, ambient term ρ_d I_a, mirror share k_s.
#macro Surface(Ambient, Rho_s, Shininess, K_s)
  finish { ambient Ambient diffuse 1 phong Rho_s phong_size Shininess reflection K_s }
#end

camera { location <0, 2.2, -7> look_at <0, 1.1, 0> up y right x angle 38 }
background { rgb <0.28, 0.45, 0.72> }

Light(<-4, 8, -6>, 60)
Light(<5, 6, -4>, 25)

polygon {
  5, <-6, 0, -4>, <6, 0, -4>, <6, 0, 14>, <-6, 0, 14>, <-6, 0, -4>
  // A checker in space; a hair's shift keeps y = 0 off its boundary. Negating z swaps the colours.
  pigment { checker rgb <0.85, 0.72, 0.10>, rgb <0.75, 0.08, 0.06> translate -1e-4*y }
  Surface(0.1, 0, 1, 0)
}

#declare Glass_center = <-0.6, 1.45, -1.5>;
sphere {
  Glass_center, 0.9
  pigment { rgb 0 transmit 0.9 }
  finish { ambient 0 diffuse 0 phong 0.6 phong_size 200 reflection 0.1 }
  interior { ior 1.5 }
}
// vis(i) is 0 or 1 on the slides: glass casts a full shadow. POV-Ray lets light through, so an unseen
// opaque ball inside stops it.
sphere { Glass_center, 0.9*0.9999 pigment { rgb 0 } no_image no_reflection }

sphere { <0.95, 1, 0.6>, 1 pigment { rgb 0.1 } Surface(0.1, 0.6, 100, 0.7) }
sphere { <-1.75, 0.4, 0.3>, 0.4 pigment { rgb <0.08, 0.25, 0.65> } Surface(0.1, 0.4, 40, 0.05) }
