use std::collections::HashMap;
use std::ops::Range as Span;
use std::path::Path;

use glam::{DAffine3, DMat3, DVec3};
use toml::Spanned;

use super::check::{Problem, Range, beside, excerpt, in_range, is_in_space, within_limit};
use super::report::{LoadError, WarningKind, Warnings};
use super::tables::{
    CameraTable, MaterialTable, MeshTable, PigmentValue, SceneFile, SphereTable, Triple,
};
use super::{
    Loaded, MAX_COORDINATE, MAX_CORNERS, MAX_COUNT, Open, empty_scene, finish, frame, obj,
};
use crate::Rgb;
use crate::geometry::{Bounds3, Sphere, triangulate};
use crate::scene::counts::is_zero_area;
use crate::scene::{
    Camera, CameraError, Lens, Material, MaterialId, Mesh, Motion, Part, Pigment, PointLight,
    Scene, SphereObject,
};

/// See [`super::parse_scene`].
pub(super) fn parse(
    text: &str,
    name: &str,
    folder: &Path,
    open: Open<'_>,
) -> Result<Loaded, LoadError> {
    let source = Source { text, name };
    let file: SceneFile = toml::from_str(text).map_err(|error| source.explain(&error))?;
    let mut warnings = Warnings::default();
    let mut scene = empty_scene();
    scene.ambient = source.color_or_black("ambient", &file.ambient, Range::Radiance)?;
    scene.background = source.color_or_black("background", &file.background, Range::Radiance)?;
    for light in &file.light {
        scene.lights.push(PointLight {
            position: source.point("position", &light.position)?,
            intensity: source.color("intensity", &light.intensity, Range::Radiance)?,
        });
    }
    scene.materials =
        file.material.values().map(|table| source.material(table)).collect::<Result<_, _>>()?;
    let names: Vec<&str> = file.material.keys().map(String::as_str).collect();
    let mut material_names: Vec<String> = file.material.keys().cloned().collect();
    for table in &file.polygon {
        let material = source.material_id(&names, &table.material)?;
        source.add_polygon(&mut scene.mesh, &table.vertices, material)?;
    }
    let mut motions = Motions::default();
    for table in &file.mesh {
        let material =
            table.material.as_ref().map(|name| source.material_id(&names, name)).transpose()?;
        let first = scene.mesh.triangles.len();
        let added = source.add_mesh(&mut scene, table, material, folder, open, &mut warnings)?;
        material_names.extend(added);
        if let Some(displacement) = &table.displacement {
            let triangles = first..scene.mesh.triangles.len();
            let bounds = Bounds3::of_points(triangles.clone().flat_map(|k| scene.mesh.corners(k)));
            motions.going(source.way(displacement, bounds)?).parts.push(Part::Triangles(triangles));
        }
    }
    for table in &file.sphere {
        let material = source.material_id(&names, &table.material)?;
        let sphere = source.sphere(table, material)?;
        let index = scene.spheres.len();
        scene.spheres.push(sphere);
        if let Some(displacement) = &table.displacement {
            let way = source.way(displacement, sphere.shape.bounds())?;
            motions.going(way).parts.push(Part::Spheres(index..index + 1));
        }
    }
    scene.motions = motions.list;
    if scene.mesh.triangles.is_empty() && scene.spheres.is_empty() {
        let cure = "add a [[sphere]], [[mesh]] or [[polygon]]";
        return Err(LoadError::at(name, None, "nothing to draw", cure));
    }
    match &file.camera {
        Some(table) => scene.camera = source.camera(table)?,
        None => frame(&mut scene, name)?,
    }
    if !scene.has_light() {
        warnings.add(name, None, WarningKind::NoLight);
    }
    Ok(finish(name, scene, material_names, warnings))
}

/// Motions as they are found: what goes the same way moves together.
#[derive(Default)]
struct Motions {
    list: Vec<Motion>,
    known: HashMap<[u64; 3], usize>,
}

impl Motions {
    fn going(&mut self, displacement: DVec3) -> &mut Motion {
        let Self { list, known } = self;
        let index = *known.entry(displacement.to_array().map(f64::to_bits)).or_insert(list.len());
        if index == list.len() {
            list.push(Motion { displacement, ..Motion::default() });
        }
        &mut list[index]
    }
}

/// The text of a scene file, to name lines in it.
struct Source<'a> {
    text: &'a str,
    name: &'a str,
}

impl Source<'_> {
    fn error(
        &self,
        span: Span<usize>,
        (problem, cure): (impl Into<String>, impl Into<String>),
    ) -> LoadError {
        let before = self.text.as_bytes().get(..span.start).unwrap_or_default();
        let line = 1 + before.iter().filter(|&&byte| byte == b'\n').count();
        LoadError::at(self.name, line, problem, cure)
    }

    /// A refusal of the parser, with the nearest of the known keys where one is mistyped.
    fn explain(&self, error: &toml::de::Error) -> LoadError {
        let message = error.message().replace('\n', ", ");
        let mut quoted = message.split('`').skip(1).step_by(2);
        let cure = match quoted.next() {
            Some(key) if message.starts_with("unknown field") => nearest(key, quoted),
            Some(_) if message.starts_with("missing field") => "add it".to_owned(),
            _ if message == "invalid type: map, expected a sequence" => {
                "there may be several: write its name in double brackets, such as [[light]]"
                    .to_owned()
            }
            _ if message.ends_with("expected f64") => "write a number such as -1.5".to_owned(),
            _ => "correct the value or the syntax".to_owned(),
        };
        let problem = message.split(", expected one of").next().unwrap_or_default();
        let problem: String = problem.chars().take(200).collect();
        match error.span() {
            Some(span) => self.error(span, (problem, cure)),
            None => LoadError::at(self.name, None, problem, cure),
        }
    }

    fn number(&self, name: &str, value: &Spanned<f64>, range: Range) -> Result<f64, LoadError> {
        in_range(name, *value.get_ref(), range).map_err(|problem| self.error(value.span(), problem))
    }

    fn color(&self, name: &str, value: &Spanned<Triple>, range: Range) -> Result<Rgb, LoadError> {
        check_color(name, *value.get_ref(), range)
            .map_err(|problem| self.error(value.span(), problem))
    }

    fn color_or_black(
        &self,
        name: &str,
        value: &Option<Spanned<Triple>>,
        range: Range,
    ) -> Result<Rgb, LoadError> {
        value.as_ref().map_or(Ok(Rgb::ZERO), |value| self.color(name, value, range))
    }

    fn point(&self, name: &str, value: &Spanned<[f64; 3]>) -> Result<DVec3, LoadError> {
        check_point(name, (*value.get_ref()).into())
            .map_err(|problem| self.error(value.span(), problem))
    }

    fn camera(&self, table: &CameraTable) -> Result<Camera, LoadError> {
        let camera = Camera {
            eye: self.point("eye", &table.eye)?,
            look_at: self.point("look_at", &table.look_at)?,
            up: table.up.as_ref().map_or(Ok(DVec3::Y), |up| self.point("up", up))?,
            fov: *table.fov.get_ref(),
            lens: self.lens(table)?,
        };
        camera.check().map_err(|error| {
            let span = match error {
                CameraError::NotFinite | CameraError::NoDirection => table.look_at.span(),
                CameraError::UpAlongView => {
                    table.up.as_ref().map_or(table.look_at.span(), Spanned::span)
                }
                CameraError::Fov => table.fov.span(),
                CameraError::Lens => table.lens.as_ref().map_or(table.fov.span(), Spanned::span),
                CameraError::Focus => table.focus.as_ref().map_or(table.fov.span(), Spanned::span),
            };
            self.error(span, error.problem_and_cure())
        })?;
        Ok(camera)
    }

    fn lens(&self, table: &CameraTable) -> Result<Option<Lens>, LoadError> {
        match (&table.lens, &table.focus) {
            (None, None) => Ok(None),
            (Some(radius), Some(focus)) => {
                Ok(Some(Lens { radius: *radius.get_ref(), focus: *focus.get_ref() }))
            }
            (Some(radius), None) => {
                let cure = "add `focus`, the distance of what is sharp along the view axis";
                Err(self.error(radius.span(), ("a lens without focus", cure)))
            }
            (None, Some(focus)) => {
                let cure = "add `lens`, its radius; without one everything is sharp";
                Err(self.error(focus.span(), ("a focus without lens", cure)))
            }
        }
    }

    fn material(&self, table: &MaterialTable) -> Result<Material, LoadError> {
        let share = |name, value| self.color_or_black(name, value, Range::Share);
        let number = |name, value: &Option<Spanned<f64>>, range| {
            value.as_ref().map_or(Ok(1.0), |value| self.number(name, value, range))
        };
        let black = Ok(Pigment::Solid(Rgb::ZERO));
        Ok(Material {
            rho_d: table.rho_d.as_ref().map_or(black, |value| {
                check_pigment(value.get_ref()).map_err(|problem| self.error(value.span(), problem))
            })?,
            rho_s: share("rho_s", &table.rho_s)?,
            shininess: number("shininess", &table.shininess, Range::NotNegative)?,
            k_s: share("k_s", &table.k_s)?,
            k_t: share("k_t", &table.k_t)?,
            gloss: table
                .gloss
                .as_ref()
                .map(|value| self.number("gloss", value, Range::Gloss))
                .transpose()?,
            refractive_index: number("refractive_index", &table.refractive_index, Range::Index)?,
            emission: self.color_or_black("emission", &table.emission, Range::Radiance)?,
        })
    }

    fn material_id(&self, names: &[&str], name: &Spanned<String>) -> Result<MaterialId, LoadError> {
        let wanted = name.get_ref().as_str();
        // The names are a map's keys, in order.
        names.binary_search(&wanted).map(|i| MaterialId(i as u32)).map_err(|_| {
            let problem = format!("unknown material `{}`", excerpt(wanted));
            self.error(name.span(), (problem, nearest(wanted, names.iter().copied())))
        })
    }

    fn sphere(&self, table: &SphereTable, id: MaterialId) -> Result<SphereObject, LoadError> {
        let center = self.point("center", &table.center)?;
        let radius = self.number("radius", &table.radius, Range::Positive)?;
        check_point("center + radius", center + radius)
            .map_err(|problem| self.error(table.radius.span(), problem))?;
        Ok(SphereObject { shape: Sphere { center, radius }, material: id })
    }

    /// The way that what is in `bounds` goes.
    fn way(&self, move_: &Spanned<[f64; 3]>, bounds: Bounds3) -> Result<DVec3, LoadError> {
        let way = self.point("move", move_)?;
        if !bounds.is_empty() {
            for corner in [bounds.min, bounds.max] {
                check_point("the place after the move", corner + way)
                    .map_err(|problem| self.error(move_.span(), problem))?;
            }
        }
        Ok(way)
    }

    fn add_polygon(
        &self,
        mesh: &mut Mesh,
        vertices: &Spanned<Vec<[f64; 3]>>,
        material: MaterialId,
    ) -> Result<(), LoadError> {
        let invalid = |problem: Problem| self.error(vertices.span(), problem);
        let corners: Vec<DVec3> = vertices.get_ref().iter().map(|&p| p.into()).collect();
        for &corner in &corners {
            check_point("vertices", corner).map_err(invalid)?;
        }
        within_limit(corners.len(), "corners in one polygon", MAX_CORNERS, "split it")
            .map_err(invalid)?;
        if corners.len() < 3 {
            let problem = format!("a polygon with {} corners", corners.len());
            return Err(invalid((problem, "give it at least 3")));
        }
        let mut parts = Vec::new();
        let defects = triangulate(&corners, &mut parts);
        let refuse = |problem: &str, cure| Err(invalid((problem.to_owned(), cure)));
        if defects.self_intersecting {
            return refuse("the polygon crosses itself", "order the vertices along its border");
        }
        if defects.non_planar {
            return refuse("the polygon is not planar", "split it into triangles");
        }
        if parts.iter().all(|part| is_zero_area(part.map(|i| corners[i as usize]))) {
            return refuse("the polygon has no area", "give it 3 corners that are not on one line");
        }
        let first = mesh.positions.len();
        within_limit(first + corners.len(), "vertices", MAX_COUNT, "remove polygons")
            .map_err(invalid)?;
        mesh.positions.extend(corners);
        let parts: Vec<[u32; 3]> =
            parts.iter().map(|part| part.map(|i| i + first as u32)).collect();
        mesh.push_face(material, &parts);
        Ok(())
    }

    /// Adds the mesh; returns the names of the materials that it brings.
    fn add_mesh(
        &self,
        scene: &mut Scene,
        table: &MeshTable,
        material: Option<MaterialId>,
        folder: &Path,
        open: Open<'_>,
        warnings: &mut Warnings,
    ) -> Result<Vec<String>, LoadError> {
        let transform = self.transform(table)?;
        let path = beside(folder, "obj", table.obj.get_ref())
            .map_err(|problem| self.error(table.obj.span(), problem))?;
        let inside = |path: &Path, within: Option<&Path>| open(path, within.or(Some(folder)));
        let of_file = material.map_or(obj::Materials::Own, |_| obj::Materials::Replaced);
        let (mesh, materials) =
            obj::read_obj(&path, of_file, &inside, warnings).map_err(|error| match error {
                LoadError::Unreadable { reason, .. } => {
                    let problem = format!("obj `{}`: {reason}", excerpt(table.obj.get_ref()));
                    let cure = "mesh files are looked for from the scene's folder";
                    self.error(table.obj.span(), (problem, cure))
                }
                other => other,
            })?;
        let invalid = |problem: Problem| self.error(table.obj.span(), problem);
        let vertices = scene.mesh.positions.len() + mesh.positions.len();
        let triangles = scene.mesh.triangles.len() + mesh.triangles.len();
        within_limit(vertices, "vertices", MAX_COUNT, "use smaller meshes").map_err(invalid)?;
        within_limit(triangles, "triangles", MAX_COUNT, "use smaller meshes").map_err(invalid)?;
        for &p in &mesh.positions {
            check_point("a vertex", transform.transform_point3(p)).map_err(invalid)?;
        }
        let first_material = material.map_or(scene.materials.len() as u32, |id| id.0);
        let (names, materials): (Vec<_>, Vec<_>) = materials.into_iter().unzip();
        scene.materials.extend(materials);
        scene.mesh.append(&mesh, transform, first_material);
        Ok(names)
    }

    /// Scale, then turn about x, y and z in this order, then move.
    fn transform(&self, table: &MeshTable) -> Result<DAffine3, LoadError> {
        let vector = |name, value: &Option<Spanned<[f64; 3]>>| {
            value.as_ref().map_or(Ok(DVec3::ZERO), |value| self.point(name, value))
        };
        let scale = table.scale.as_ref().map_or(Ok(DVec3::ONE), |value| {
            let scale = value.get_ref().vector();
            let is_good = |s: f64| (1.0 / MAX_COORDINATE..=MAX_COORDINATE).contains(&s.abs());
            if scale.to_array().into_iter().all(is_good) {
                Ok(scale)
            } else {
                let cure = "it must be finite and not zero";
                Err(self.error(value.span(), (format!("scale is {:?}", scale.to_array()), cure)))
            }
        })?;
        let [x, y, z] = vector("rotate", &table.rotate)?.to_array().map(f64::to_radians);
        let turn =
            DMat3::from_rotation_z(z) * DMat3::from_rotation_y(y) * DMat3::from_rotation_x(x);
        Ok(DAffine3 {
            matrix3: turn * DMat3::from_diagonal(scale),
            translation: vector("translate", &table.translate)?,
        })
    }
}

fn check_color(name: &str, color: Triple, range: Range) -> Result<Rgb, Problem> {
    let color = color.vector();
    for channel in color.to_array() {
        in_range(name, channel, range)?;
    }
    Ok(color)
}

fn check_pigment(value: &PigmentValue) -> Result<Pigment, Problem> {
    Ok(match value {
        PigmentValue::Solid(color) => Pigment::Solid(check_color("rho_d", *color, Range::Share)?),
        PigmentValue::Checker { checker: [even, odd], side } => Pigment::Checker {
            even: check_color("rho_d", *even, Range::Share)?,
            odd: check_color("rho_d", *odd, Range::Share)?,
            side: in_range("side", *side, Range::Positive)?,
        },
    })
}

fn check_point(name: &str, point: DVec3) -> Result<DVec3, Problem> {
    if is_in_space(point) {
        Ok(point)
    } else {
        let problem = format!("{name} is {:?}", point.to_array());
        Err((problem, "coordinates must be finite and below 1e50"))
    }
}

/// The cure for a name that is not known: the known ones, the most similar first. Names may be long
/// and many: only the start of each is compared, and the first ten are shown.
fn nearest<'a>(wanted: &str, known: impl Iterator<Item = &'a str>) -> String {
    const SHOWN: usize = 10;
    let wanted = excerpt(wanted);
    let mut known: Vec<String> = known.map(excerpt).collect();
    known.sort_by_cached_key(|name| strsim::damerau_levenshtein(&wanted, name));
    match known.len() {
        0 => "no such name is defined".to_owned(),
        1..=SHOWN => format!("the known ones are {}", known.join(", ")),
        count => {
            format!("of {count} known ones the nearest are {}", known[..SHOWN].join(", "))
        }
    }
}
