//! One floor: its maps from the survey walks, its test walks scored on them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use fieldwalk::map::FloorIndex;
use fieldwalk::survey::{SurveyParams, SurveyWalk, build_floor};
use fieldwalk::system::Recipe;
use fieldwalk_formats::error::FormatError;
use fieldwalk_formats::ilc::floor_ordinal;
use rayon::prelude::*;

use crate::evaluation::{ReadTest, Row, RowGroup, Start, TestWalk, WalkScore, is_test_walk, score};
use crate::floors::Floor;
use crate::walks::ReadWalk;

/// What to score, and how.
#[derive(Clone, Debug)]
pub struct Evaluation {
    /// The systems.
    pub recipes: Vec<Recipe>,
    /// What they are told of the start.
    pub start: Start,
    /// The random seeds; every walk is scored once with each.
    pub seeds: Vec<u64>,
    /// The folds whose walks are tested; each has a map of its own.
    pub folds: Vec<u8>,
    /// How maps are built.
    pub survey: SurveyParams,
}

/// The scores of a floor's test walks.
#[derive(Debug, Default)]
pub struct FloorScores {
    /// The test walks.
    pub walks: Vec<ScoredWalk>,
    /// The test walks without two waypoints: nothing to score.
    pub without_waypoints: Vec<PathBuf>,
    /// The walks, of survey or test, that say they were taken on another floor, and its name; they are left out.
    pub of_other_floors: Vec<(PathBuf, String)>,
    /// Whether a folder says which walks test; folds do otherwise.
    pub has_test_folder: bool,
}

/// A test walk with its scores.
#[derive(Debug)]
pub struct ScoredWalk {
    /// Its file.
    pub path: PathBuf,
    /// The map that has not seen it.
    pub floor: Arc<FloorIndex>,
    /// Per recipe, per seed.
    pub scores: Vec<Vec<WalkScore>>,
}

impl Evaluation {
    /// Number of times that [`Evaluation::score_floor`] reports a walk as done.
    pub fn n_ticks(&self, floor: &Floor) -> usize {
        self.survey_traces(floor).count()
            + self.splits(floor).into_iter().map(|split| split.test_traces(floor).count()).sum::<usize>()
    }

    /// Maps `floor` per fold and scores the fold's test walks; `tick` is called, from any thread, for every walk read.
    ///
    /// # Errors
    /// When a trace cannot be read, and when the survey walks give no map: scores of fewer walks than the floor has
    /// would not compare.
    pub fn score_floor(&self, floor: &Floor, tick: impl Fn() + Sync) -> Result<FloorScores, FormatError> {
        let survey: Vec<&PathBuf> = self.survey_traces(floor).collect();
        let survey = survey
            .par_iter()
            .map(|path| {
                let read = ReadWalk::open(path, floor.plan.georeference);
                tick();
                read
            })
            .collect::<Result<Vec<_>, _>>()?;
        let mut of_other_floors: BTreeMap<PathBuf, String> = survey
            .iter()
            .filter_map(|read| Some((read.path.clone(), read.other_floor(&floor.name)?.to_owned())))
            .collect();
        let folds = self
            .splits(floor)
            .into_par_iter()
            .map(|split| self.score_split(floor, split, &survey, &tick))
            .collect::<Result<Vec<_>, _>>()?;
        let has_test_folder = floor.test_traces.is_some();
        let mut scores = FloorScores { has_test_folder, ..FloorScores::default() };
        for fold in folds {
            scores.walks.extend(fold.walks);
            scores.without_waypoints.extend(fold.without_waypoints);
            of_other_floors.extend(fold.of_other_floors);
        }
        // With several folds a walk both surveys and tests.
        scores.of_other_floors = of_other_floors.into_iter().collect();
        Ok(scores)
    }

    fn score_split(
        &self,
        floor: &Floor,
        split: Split,
        survey: &[ReadWalk],
        tick: &(impl Fn() + Sync),
    ) -> Result<FloorScores, FormatError> {
        let walks: Vec<SurveyWalk> = survey
            .iter()
            .filter(|read| split.is_survey_walk(&read.path) && read.other_floor(&floor.name).is_none())
            .map(|read| read.walk.clone())
            .collect();
        let map = build_floor(&floor.name, floor_ordinal(&floor.name), &floor.plan, &walks, &self.survey)
            .map_err(|error| {
                let walks = match split {
                    Split::Fold(fold) => format!("walks outside fold {fold}"),
                    Split::ByFolder => "survey walks".to_owned(),
                };
                FormatError::malformed(format!("no map of the {walks}: {error}"), "")
            })?;
        let index = Arc::new(FloorIndex::new(map));
        let tests: Vec<&PathBuf> = split.test_traces(floor).collect();
        let scored = tests
            .par_iter()
            .map(|path| {
                let scored = self.score_walk(&index, floor, path);
                tick();
                scored
            })
            .collect::<Result<Vec<_>, _>>()?;
        let mut scores = FloorScores::default();
        for (path, scored) in tests.into_iter().zip(scored) {
            match scored {
                Scored::Walk(walk) => scores.walks.push(walk),
                Scored::WithoutWaypoints => scores.without_waypoints.push(path.clone()),
                Scored::OfOtherFloor(name) => scores.of_other_floors.push((path.clone(), name)),
            }
        }
        Ok(scores)
    }

    fn score_walk(&self, index: &Arc<FloorIndex>, floor: &Floor, path: &Path) -> Result<Scored, FormatError> {
        let nodes = floor.nodes.as_deref();
        let walk = match TestWalk::read(path, &floor.name, floor.plan.georeference, nodes)? {
            ReadTest::Walk(walk) => walk,
            ReadTest::WithoutWaypoints => return Ok(Scored::WithoutWaypoints),
            ReadTest::OfOtherFloor(name) => return Ok(Scored::OfOtherFloor(name)),
        };
        let with_seeds =
            |recipe| self.seeds.iter().map(|&seed| score(index, recipe, self.start, seed, &walk)).collect();
        let scores = self.recipes.iter().map(with_seeds).collect();
        Ok(Scored::Walk(ScoredWalk { path: path.into(), floor: Arc::clone(index), scores }))
    }

    /// The ways in which the floor's walks are divided, one map each.
    fn splits(&self, floor: &Floor) -> Vec<Split> {
        match floor.test_traces {
            Some(_) => vec![Split::ByFolder],
            None => self.folds.iter().map(|&fold| Split::Fold(fold)).collect(),
        }
    }

    /// The traces that survey some split's map.
    fn survey_traces<'a>(&self, floor: &'a Floor) -> impl Iterator<Item = &'a PathBuf> {
        let splits = self.splits(floor);
        floor.traces.iter().filter(move |path| splits.iter().any(|split| split.is_survey_walk(path)))
    }

    /// The rows of the floors `scores`, pooled, under the name `floor`.
    pub fn rows(&self, dataset: &str, floor: &str, scores: &[&FloorScores]) -> Vec<Row> {
        let start = self.start.to_string();
        let walks: Vec<&ScoredWalk> = scores.iter().flat_map(|floor| &floor.walks).collect();
        let rows_of = |(k, recipe): (usize, &Recipe)| {
            let system = &recipe.name;
            let (n_walks, seeds) = (walks.len(), self.seeds.len());
            let group = RowGroup { dataset, floor, system, start: &start, n_walks, seeds };
            group.rows(&walks.iter().flat_map(|walk| &walk.scores[k]).collect::<Vec<_>>())
        };
        self.recipes.iter().enumerate().flat_map(rows_of).collect()
    }
}

impl FloorScores {
    /// Number of test walks scored, seeds not counted.
    pub fn n_walks(&self) -> usize {
        self.walks.len()
    }

    /// Number of test walks whose start lay off the plan with some system or seed.
    pub fn n_starts_refused(&self) -> usize {
        let is_refused =
            |walk: &&ScoredWalk| walk.scores.iter().flatten().any(|score| score.is_start_refused);
        self.walks.iter().filter(is_refused).count()
    }
}

/// What became of a test walk.
#[derive(Debug)]
enum Scored {
    Walk(ScoredWalk),
    WithoutWaypoints,
    OfOtherFloor(String),
}

/// A division of a floor's walks into those that survey and those that test.
#[derive(Clone, Copy, Debug)]
enum Split {
    /// By the names of the files.
    Fold(u8),
    /// As the floor's folder has it.
    ByFolder,
}

impl Split {
    fn is_survey_walk(self, path: &Path) -> bool {
        match self {
            Self::Fold(fold) => !is_test_walk(path, fold),
            Self::ByFolder => true,
        }
    }

    fn test_traces(self, floor: &Floor) -> impl Iterator<Item = &PathBuf> {
        let set_aside = floor.test_traces.iter().flatten().filter(move |_| matches!(self, Self::ByFolder));
        let of_fold = floor.traces.iter().filter(move |path| !self.is_survey_walk(path));
        set_aside.chain(of_fold)
    }
}
