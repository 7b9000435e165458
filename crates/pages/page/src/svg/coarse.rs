//! Paths that need not be finer than can be seen: in whole tenths of a pixel, or hundredths, each point by its distance
//! from the one before.

use std::fmt::Write as _;

/// Attributes that give a path in tenths of a pixel its size.
pub(super) const COARSE: &str = "data-scale=\"0.1\" transform=\"scale(.1)\"";

/// The same for hundredths.
pub(super) const FINE: &str = "data-scale=\"0.01\" transform=\"scale(.01)\"";

/// Points between two others may lie so far from the straight line that is drawn, in units of the path.
const TOLERANCE: f64 = 1.0;

/// In pixels, and in tenths of them.
type Pixel = (f64, f64);
type Point = (i64, i64);

fn tenths(at: Pixel) -> Point {
    parts(at, 10.0)
}

fn parts((x, y): Pixel, of_pixel: f64) -> Point {
    ((of_pixel * x).round() as i64, (of_pixel * y).round() as i64)
}

/// Two numbers; a minus sign separates as well as a space does.
fn pair(d: &mut String, (x, y): Point) {
    let separates = d.ends_with(|c: char| !c.is_ascii_digit()) || x < 0;
    let _ = write!(d, "{}{x}{}{y}", if separates { "" } else { " " }, if y < 0 { "" } else { " " });
}

/// A line, broken where a point is missing.
pub(super) fn line(points: &[Option<Pixel>]) -> String {
    line_of(points, 10.0)
}

/// A line in hundredths of a pixel.
pub(super) fn fine_line(points: &[Option<Pixel>]) -> String {
    line_of(points, 100.0)
}

fn line_of(points: &[Option<Pixel>], of_pixel: f64) -> String {
    let mut line = Line::default();
    for point in points {
        match point {
            Some(point) => line.to(parts(*point, of_pixel)),
            None => line.lift(),
        }
    }
    line.lift();
    line.d
}

/// A line as it is written: the path, the last point that is written, the way from there to the pen, and between which
/// slopes the next point has to lie so that a straight line passes all points since.
#[derive(Default)]
struct Line {
    d: String,
    written: Option<Point>,
    way: Point,
    slopes: Option<(f64, f64)>,
    begins: bool,
}

impl Line {
    fn to(&mut self, at: Point) {
        let Some(written) = self.written else {
            self.d.push('M');
            pair(&mut self.d, at);
            (self.written, self.begins) = (Some(at), true);
            return;
        };
        let from = |written: Point| (at.0 - written.0, at.1 - written.1);
        if self.way != (0, 0) && !self.passes(from(written)) {
            self.write();
        }
        self.way = from(self.written.unwrap_or(at));
        self.narrow();
    }

    /// Returns true if a straight line to there passes all points since the last one that is written.
    fn passes(&self, (x, y): Point) -> bool {
        match self.slopes {
            Some((low, high)) => {
                x.signum() == self.way.0.signum() && (low..=high).contains(&(y as f64 / x.abs() as f64))
            }
            None => x == 0 && self.way.1.signum() * (y - self.way.1).signum() >= 0,
        }
    }

    fn narrow(&mut self) {
        let (x, y) = (self.way.0.abs() as f64, self.way.1 as f64);
        if x > 0.0 {
            let (low, high) = self.slopes.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
            self.slopes = Some((low.max((y - TOLERANCE) / x), high.min((y + TOLERANCE) / x)));
        }
    }

    fn write(&mut self) {
        let way = std::mem::take(&mut self.way);
        self.slopes = None;
        if way != (0, 0) {
            if std::mem::take(&mut self.begins) {
                self.d.push('l');
            }
            pair(&mut self.d, way);
            self.written = self.written.map(|(x, y)| (x + way.0, y + way.1));
        }
    }

    fn lift(&mut self) {
        self.write();
        self.written = None;
    }
}

/// A dot at each point: a very short line with round ends.
pub(super) fn dots(points: &[Option<Pixel>]) -> String {
    let mut d = String::new();
    let mut pen = None;
    for at in points.iter().flatten().map(|point| tenths(*point)) {
        let (before, letter) = pen.map_or(((0, 0), 'M'), |pen| (pen, 'm'));
        d.push(letter);
        pair(&mut d, (at.0 - before.0, at.1 - before.1));
        d.push_str("h1");
        pen = Some((at.0 + 1, at.1));
    }
    d
}

/// Rectangles, each from a corner to the opposite one.
pub(super) fn rectangles(all: &[(Pixel, Pixel)]) -> String {
    let mut d = String::new();
    let mut pen = None;
    for (corner, opposite) in all {
        let (at, to) = (tenths(*corner), tenths(*opposite));
        let (before, letter) = pen.map_or(((0, 0), 'M'), |pen| (pen, 'm'));
        d.push(letter);
        pair(&mut d, (at.0 - before.0, at.1 - before.1));
        let (width, height) = (to.0 - at.0, to.1 - at.1);
        let _ = write!(d, "h{width}v{height}h{}z", -width);
        pen = Some(at);
    }
    d
}
