//! Figures of the bar, the tool and the chuck, and what is clamped for a program.

use std::fmt;

use figures::{Definition, FigureError, Figures};

use crate::bar::BarData;
use crate::contour::{Contour, Curve};
use crate::cut::Jaws;
use crate::reach::ContourError;
use crate::tool::{Tool, ToolData};

/// Where `chuck.z_mm` is out of the way.
const NO_CHUCK: f64 = -1000.0;

/// The figures. A size of the bar that is 0 is taken from the program.
pub static FIGURES: [Definition; 11] = [
    Definition::number("stock.diameter_mm", "mm", 0.0, 1000.0, "0", "diameter of the bar; 0: what the program needs"),
    Definition::number("stock.length_mm", "mm", 0.0, 3000.0, "0", "length of the bar; 0: what the program needs"),
    Definition::number("stock.bore_mm", "mm", 0.0, 999.0, "0", "bore of the bar; 0: solid"),
    Definition::number("stock.face_mm", "mm", -2000.0, 2000.0, "0", "Z of the front face of the bar"),
    Definition::number("tool.nose_mm", "mm", 0.0, 50.0, "0.4", "nose radius of the tool"),
    Definition::whole("tool.tip", "", 1, 9, "3", "tip direction, as lathe controls number it"),
    Definition::number(
        "tool.front_deg",
        "deg",
        1.0,
        190.0,
        "87",
        "front edge, from +Z (tips 3, 8, 9; others mirrored)",
    ),
    Definition::number(
        "tool.back_deg",
        "deg",
        -10.0,
        179.0,
        "52",
        "back edge, from +Z (tips 3, 8, 9; others mirrored)",
    ),
    Definition::number("tool.edge_mm", "mm", 0.1, 500.0, "11", "length of the edges; beyond it is the holder"),
    Definition::number(
        "chuck.z_mm",
        "mm",
        -1000.0,
        2000.0,
        "-1000",
        "Z of the face of the jaws; -1000: out of the way",
    ),
    Definition::number("chuck.diameter_mm", "mm", 1.0, 1000.0, "125", "diameter of the chuck"),
];

/// What is clamped and cut for one program.
#[derive(Clone, Debug)]
pub struct Clamped {
    /// The bar.
    pub bar: BarData,
    /// The tool.
    pub tool: Tool,
    /// The chuck, unless it is out of the way.
    pub jaws: Option<Jaws>,
    /// What should come out.
    pub contour: Contour,
}

/// Why nothing was clamped.
#[derive(Clone, Debug, PartialEq)]
pub enum SetupError {
    /// Figures contradict each other, or one is missing.
    Figures(FigureError),
    /// The program asks for what the bar or the tool can't give.
    Program(Vec<ContourError>),
}

impl fmt::Display for SetupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Figures(error) => error.fmt(f),
            Self::Program(errors) => {
                let texts: Vec<String> = errors.iter().map(ToString::to_string).collect();
                f.write_str(&texts.join("; "))
            }
        }
    }
}

impl std::error::Error for SetupError {}

impl From<FigureError> for SetupError {
    fn from(error: FigureError) -> Self {
        Self::Figures(error)
    }
}

fn contradiction(text: String) -> SetupError {
    SetupError::Figures(FigureError::Contradiction(text))
}

/// Whether any figure of bar, tool or chuck was given: what was not said can't be wrong.
fn is_given(figures: &Figures) -> bool {
    figures
        .iter()
        .any(|(definition, text)| FIGURES.iter().any(|own| own.name == definition.name) && text != definition.default)
}

impl Clamped {
    /// Clamps a bar for a program's `curves`; `None` if it cuts nothing and no bar was given.
    ///
    /// Without any figure of bar, tool or chuck the bar is what the program needs, and what the tool can't reach is no
    /// error.
    ///
    /// # Errors
    /// [`SetupError`].
    pub fn new(figures: &Figures, curves: &[Curve]) -> Result<Option<Self>, SetupError> {
        let get = |name| figures.number(name);
        let data = ToolData {
            nose: get("tool.nose_mm")?,
            tip: u8::try_from(figures.whole("tool.tip")?).unwrap_or(0),
            front: get("tool.front_deg")?,
            back: get("tool.back_deg")?,
            edge: get("tool.edge_mm")?,
        };
        let tool = Tool::new(data).map_err(|error| contradiction(format!("tool: {error}")))?;
        let chuck = get("chuck.z_mm")?;
        let jaws = (chuck > NO_CHUCK).then_some(Jaws { z: chuck, radius: get("chuck.diameter_mm")? / 2.0 });
        let Some(bar) = bar(figures, curves, &tool, jaws)? else { return Ok(None) };
        let contour = Contour::new(curves, &tool, bar);
        if is_given(figures) && !contour.errors().is_empty() {
            return Err(SetupError::Program(contour.errors().to_vec()));
        }
        Ok(Some(Self { bar, tool, jaws, contour }))
    }

    /// Where the part runs out of a bar whose size was given: line of the program, Z and X in mm.
    #[must_use]
    pub fn leaves(&self, figures: &Figures) -> Option<(u32, crate::Point)> {
        if is_given(figures) { self.contour.leaves() } else { None }
    }
}

/// Room behind the contour and length in the jaws of a bar whose length is not given, mm.
const BEHIND: f64 = 20.0;
/// Largest bar that is made up for a program, mm: what is larger is no lathe work.
const MOST: f64 = 4000.0;

fn bar(figures: &Figures, curves: &[Curve], tool: &Tool, jaws: Option<Jaws>) -> Result<Option<BarData>, SetupError> {
    let get = |name| figures.number(name);
    let (diameter, length, bore) = (get("stock.diameter_mm")?, get("stock.length_mm")?, get("stock.bore_mm")?);
    let mut face = get("stock.face_mm")?;
    let places: Vec<_> = curves.iter().flat_map(Curve::chords).map(|place| tool.centre(place)).collect();
    let lowest = places.iter().map(|place| place.z - tool.nose()).fold(f64::INFINITY, f64::min);
    if diameter <= 0.0 && length <= 0.0 && lowest > face {
        // all of the program is in front of Z0: its zero lies at the chuck
        face = places.iter().map(|place| place.z).fold(f64::NEG_INFINITY, f64::max);
    }
    let side = if tool.is_inside() { tool.nose() + 2.0 } else { -tool.nose() };
    let widest = places.iter().filter(|place| place.z <= face).map(|place| place.x + side).fold(0.0, f64::max);
    let radius = if diameter > 0.0 { diameter / 2.0 } else { widest.ceil() };
    let jaw = jaws.map_or(f64::INFINITY, |jaws| jaws.z);
    let back = if length > 0.0 { face - length } else { (lowest - BEHIND).min(jaw - BEHIND) };
    if diameter <= 0.0 && (widest <= 0.0 || radius > MOST) || length <= 0.0 && !(face - MOST..face).contains(&back) {
        if diameter > 0.0 || length > 0.0 {
            return Err(contradiction(
                "stock: give stock.diameter_mm and stock.length_mm both; this program does not say what it needs"
                    .into(),
            ));
        }
        return Ok(None);
    }
    if bore >= 2.0 * radius {
        return Err(contradiction(format!(
            "stock.bore_mm = {bore} and a bar of {} mm: the bore must be smaller than the bar",
            2.0 * radius
        )));
    }
    if let Some(Jaws { z, radius: jaw_radius }) = jaws {
        if z >= face {
            return Err(contradiction(format!(
                "chuck.z_mm = {z} and the bar's face at Z{face}: nothing of the bar stands out of the chuck"
            )));
        }
        if z <= back {
            return Err(contradiction(format!(
                "chuck.z_mm = {z} and the bar's back end at Z{back}: the chuck does not hold the bar; make \
                 stock.length_mm more than {}",
                face - z
            )));
        }
        if jaw_radius <= radius {
            return Err(contradiction(format!(
                "chuck.diameter_mm = {} and a bar of {} mm: the chuck can't hold it",
                2.0 * jaw_radius,
                2.0 * radius
            )));
        }
    }
    Ok(Some(BarData { radius, bore: bore / 2.0, back, face }))
}
