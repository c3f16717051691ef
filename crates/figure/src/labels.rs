//! Where labels fit: beside what they name, over nothing else.

use crate::geometry::{Point, Rect, segments_cross};

/// What is left of an area as things are put into it.
#[derive(Clone, Debug)]
pub(crate) struct Room {
    area: Rect,
    things: Vec<(Owner, Thing)>,
}

/// The number of the series a thing belongs to; labels and lines of the chart itself have none.
pub(crate) type Owner = Option<usize>;

#[derive(Clone, Copy, Debug)]
enum Thing {
    Box(Rect),
    Line(Point, Point),
}

impl Thing {
    fn meets(self, rect: &Rect) -> bool {
        match self {
            Self::Box(other) => other.overlaps(rect),
            Self::Line(from, to) => rect.clip(from, to).is_some(),
        }
    }

    fn is_crossed(self, a: Point, b: Point) -> bool {
        match self {
            Self::Box(rect) => rect.clip(a, b).is_some(),
            Self::Line(from, to) => segments_cross(a, b, from, to),
        }
    }
}

/// Between two labels.
const BETWEEN: f64 = 4.0;

impl Room {
    pub(crate) fn new(area: Rect) -> Self {
        Self { area, things: Vec::new() }
    }

    /// Takes a rectangle.
    pub(crate) fn take(&mut self, owner: Owner, rect: Rect) {
        self.things.push((owner, Thing::Box(rect)));
    }

    /// Takes a line.
    pub(crate) fn cross(&mut self, owner: Owner, from: Point, to: Point) {
        self.things.push((owner, Thing::Line(from, to)));
    }

    pub(crate) fn fits(&self, rect: &Rect) -> bool {
        self.area.contains(rect) && !self.things.iter().any(|(_, thing)| thing.meets(rect))
    }

    /// Takes the first of the candidates that fits and lies `apart` px from all other series, so that it
    /// is not taken for their name.
    pub(crate) fn place_name(
        &mut self,
        owner: usize,
        apart: f64,
        candidates: impl IntoIterator<Item = Rect>,
    ) -> Option<Rect> {
        let rect = candidates.into_iter().find(|rect| self.names(owner, apart, rect))?;
        self.take(None, rect.grown(BETWEEN));
        Some(rect)
    }

    /// Takes the first of the candidates that fits as a name and that a straight leader from `at`
    /// reaches over nothing but the series itself; returns it and where the leader ends.
    pub(crate) fn place_led(
        &mut self,
        owner: usize,
        apart: f64,
        at: Point,
        candidates: impl IntoIterator<Item = Rect>,
    ) -> Option<(Rect, Point)> {
        let found = candidates.into_iter().find_map(|rect| {
            let foot = rect.grown(BETWEEN).nearest(at);
            let over = |(other, thing): &(Owner, Thing)| {
                *other != Some(owner) && thing.is_crossed(at, foot)
            };
            let clear = !self.things.iter().any(over);
            (clear && self.names(owner, apart, &rect)).then_some((rect, foot))
        })?;
        self.cross(None, at, found.1);
        self.take(None, found.0.grown(BETWEEN));
        Some(found)
    }

    /// Whether a label fits and would not be taken for the name of another series.
    fn names(&self, owner: usize, apart: f64, rect: &Rect) -> bool {
        let around = rect.grown(apart);
        let near_another = |(other, thing): &(Owner, Thing)| {
            other.is_some_and(|other| other != owner) && thing.meets(&around)
        };
        self.fits(rect) && !self.things.iter().any(near_another)
    }

    /// Takes the first of the candidates that fits.
    pub(crate) fn place(&mut self, candidates: impl IntoIterator<Item = Rect>) -> Option<Rect> {
        let rect = candidates.into_iter().find(|rect| self.fits(rect))?;
        self.take(None, rect.grown(BETWEEN));
        Some(rect)
    }

    /// Middles of a 32 × 32 grid over the area, the nearest to `aim` first.
    pub(crate) fn spots(&self, aim: Point) -> Vec<Point> {
        const CELLS: u32 = 32;
        let part = |i: u32| (f64::from(i) + 0.5) / f64::from(CELLS);
        let mut spots: Vec<Point> = (0..CELLS * CELLS)
            .map(|i| {
                [
                    self.area.x + self.area.width * part(i % CELLS),
                    self.area.y + self.area.height * part(i / CELLS),
                ]
            })
            .collect();
        let distance = |p: &Point| (p[0] - aim[0]).powi(2) + (p[1] - aim[1]).powi(2);
        spots.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        spots
    }
}

/// The places of a label of `width` × `height` around the point `at`, `gap` px from it, the best first.
pub(crate) fn beside(at: Point, [width, height]: [f64; 2], gap: f64) -> [Rect; 8] {
    let [x, y] = at;
    let (left, right) = (x - gap - width, x + gap);
    let (over, under) = (y - gap - height, y + gap);
    let (middle_x, middle_y) = (x - width / 2.0, y - height / 2.0);
    let near = 0.4 * gap;
    [
        [right, middle_y],
        [x + near, y - near - height],
        [x + near, y + near],
        [middle_x, over],
        [middle_x, under],
        [x - near - width, y - near - height],
        [x - near - width, y + near],
        [left, middle_y],
    ]
    .map(|[x, y]| Rect::new(x, y, width, height))
}

/// The upper edges, in the order given, of boxes `height` tall that would like to start at `wanted`:
/// none overlap, all lie between `low` and `high` (which must have room for them), and the sum of
/// squared moves is least.
pub(crate) fn spread(wanted: &[f64], height: f64, low: f64, high: f64) -> Vec<f64> {
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    order.sort_by(|&a, &b| wanted[a].total_cmp(&wanted[b]));
    // With i box heights taken off the i-th box, not overlapping means not decreasing: a pool of
    // neighbours that would decrease shares their mean.
    let mut pools: Vec<(f64, usize)> = Vec::new();
    for (rank, &i) in order.iter().enumerate() {
        let mut pool = (wanted[i] - rank as f64 * height, 1);
        while let Some(&(mean, count)) = pools.last() {
            if mean < pool.0 {
                break;
            }
            let sum = mean * count as f64 + pool.0 * pool.1 as f64;
            pool = (sum / (count + pool.1) as f64, count + pool.1);
            pools.pop();
        }
        pools.push(pool);
    }
    let last_start = high - wanted.len() as f64 * height;
    let starts = pools.iter().flat_map(|&(mean, count)| std::iter::repeat_n(mean, count));
    let mut places = vec![0.0; wanted.len()];
    for ((rank, &i), start) in order.iter().enumerate().zip(starts) {
        places[i] = start.min(last_start).max(low) + rank as f64 * height;
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_boxes_touch_at_most_and_stay_inside() {
        assert_eq!(spread(&[50.0, 52.0, 10.0], 20.0, 0.0, 100.0), [41.0, 61.0, 10.0]);
        assert_eq!(spread(&[95.0, 96.0], 20.0, 0.0, 100.0), [60.0, 80.0]);
        assert_eq!(spread(&[-5.0, -9.0], 20.0, 0.0, 100.0), [20.0, 0.0]);
        let mut many = spread(&[30.0; 5], 20.0, 0.0, 100.0);
        many.sort_by(f64::total_cmp);
        assert_eq!(many, [0.0, 20.0, 40.0, 60.0, 80.0]);
    }

    #[test]
    fn a_label_avoids_boxes_lines_and_the_edge() {
        let mut room = Room::new(Rect::new(0.0, 0.0, 100.0, 100.0));
        room.take(None, Rect::new(60.0, 40.0, 40.0, 20.0));
        room.cross(None, [50.0, 0.0], [50.0, 45.0]);
        let found = room.place(beside([50.0, 50.0], [30.0, 16.0], 8.0)).unwrap();
        assert!(!found.overlaps(&Rect::new(60.0, 40.0, 40.0, 20.0)));
        assert!(found.clip([50.0, 0.0], [50.0, 45.0]).is_none());
        assert_eq!(room.place([found]), None, "the place is taken");
        assert_eq!(room.place([Rect::new(90.0, 90.0, 30.0, 5.0)]), None, "over the edge");
    }

    #[test]
    fn a_name_keeps_away_from_other_series_only() {
        let mut room = Room::new(Rect::new(0.0, 0.0, 100.0, 100.0));
        room.cross(Some(0), [0.0, 50.0], [100.0, 50.0]);
        let just_below = Rect::new(40.0, 54.0, 20.0, 10.0);
        assert_eq!(room.clone().place_name(1, 8.0, [just_below]), None, "it would name series 0");
        let led = Rect::new(40.0, 70.0, 20.0, 10.0);
        assert_eq!(room.clone().place_led(1, 8.0, [50.0, 30.0], [led]), None, "over series 0");
        let (_, foot) = room.clone().place_led(1, 8.0, [50.0, 55.0], [led]).unwrap();
        assert_eq!(foot, [50.0, 70.0 - BETWEEN]);
        assert_eq!(room.place_name(0, 8.0, [just_below]), Some(just_below));
    }
}
