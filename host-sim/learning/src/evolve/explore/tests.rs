use super::*;
use crate::evolve::test_support::with_task;
use glam::DVec2;
use mindgap_core::controller::When;

const TUPLE: Tuple = Tuple { left: 40, right: 50, when: When::Larger, threshold_cm: 60 };

fn prefix(left: i8) -> Prefix {
    Prefix { tuples: vec![Tuple { left, ..TUPLE }, TUPLE], from: (1, 2, 3, 4) }
}

fn stop(scatter_cm: f64, reached: f64) -> Stop {
    Stop {
        tuple: TUPLE,
        place_cm: DVec2::new(100.0, 50.0),
        heading_rad: 0.1,
        scatter_cm,
        heading_scatter_rad: 0.0,
        lost: 0.0,
        reached,
        nearness: 0.0,
    }
}

/// Returns the first commands of all elites except the start.
fn elites(archive: &Archive) -> Vec<i8> {
    archive.elites[1..].iter().map(|elite| elite.prefix.tuples[0].left).collect()
}

#[test]
fn cell_keeps_the_prefix_with_the_least_scatter() {
    with_task(|task| {
        let mut archive = Archive::new(task);
        for (left, scatter_cm) in [(1, 9.0), (2, 5.0), (3, 7.0)] {
            archive.learn(&prefix(left), &stop(scatter_cm, 0.0));
        }
        assert_eq!(elites(&archive), [2]);
        // Another place, another heading, and more tuples.
        archive.learn(&prefix(4), &Stop { place_cm: DVec2::new(100.0, 90.0), ..stop(9.0, 0.0) });
        archive.learn(&prefix(5), &Stop { heading_rad: -0.1, ..stop(9.0, 0.0) });
        let longer = Prefix { tuples: vec![Tuple { left: 6, ..TUPLE }; 3], from: (2, 2, 3, 4) };
        archive.learn(&longer, &stop(9.0, 0.0));
        assert_eq!(elites(&archive), [2, 4, 5, 6]);
    });
}

/// Six tuples cannot be extended, and a prefix that loses too many of its runs is not worth extending.
#[test]
fn prefixes_that_cannot_be_extended_are_not_elites() {
    with_task(|task| {
        let mut archive = Archive::new(task);
        archive.learn(&Prefix { tuples: vec![TUPLE; 6], from: (5, 2, 3, 4) }, &stop(1.0, 1.0));
        archive.learn(&prefix(1), &Stop { lost: 0.5, ..stop(1.0, 0.5) });
        assert!(elites(&archive).is_empty());
        assert_eq!(archive.best_candidates().iter().map(|found| found.tuples.len()).collect::<Vec<_>>(), [6, 2]);
    });
}

#[test]
fn best_prefix_of_each_starting_cell_is_a_candidate() {
    with_task(|task| {
        let mut archive = Archive::new(task);
        for (left, reached) in [(1, 0.2), (2, 0.8), (3, 0.5)] {
            archive.learn(&prefix(left), &stop(1.0, reached));
        }
        let best = archive.best_candidates();
        assert_eq!(best.iter().map(|found| found.tuples[0].left).collect::<Vec<_>>(), [2]);
    });
}

/// From the start single tuples are tried, the same ones with the same seed.
#[test]
fn search_begins_with_single_tuples_and_is_reproducible() {
    with_task(|task| {
        let tried = |seed| Archive::new(task).prefixes(&mut generator(seed, &[]));
        let tuples = |tried: Vec<Prefix>| tried.into_iter().map(|prefix| prefix.tuples).collect::<Vec<_>>();
        let first = tuples(tried(3));
        assert!(first.len() == TRIED && first.iter().all(|tuples| tuples.len() == 1));
        assert!(first == tuples(tried(3)) && first != tuples(tried(4)));
    });
}
