//! A device for a test, with the validation layers on.

use lightoven::ErrorKind;
use lightoven::gpu::{BackendChoice, Gpu};
use lightoven::headless::{Headless, HeadlessSettings, Validation};

/// Runs a test on a back end, and fails where the validation layers have something to say about it.
///
/// A device without ray queries skips their half with a message, unless `LIGHTOVEN_REQUIRE=ray_query` asks for it.
pub(crate) fn on(backend: BackendChoice, test: impl FnOnce(&Gpu)) {
    let settings = HeadlessSettings { backend, validation: Validation::On, ..HeadlessSettings::default() };
    let headless = match Headless::new(&settings) {
        Err(error) if backend == BackendChoice::RayQuery && error.kind() == ErrorKind::Unsupported => {
            let required = std::env::var("LIGHTOVEN_REQUIRE").is_ok_and(|required| required == "ray_query");
            assert!(!required, "ray query is required: {error}");
            println!("skipped: {error}");
            return;
        }
        headless => headless.expect("there is a Vulkan driver, and the validation layers"),
    };
    test(headless.gpu());
    assert_eq!(headless.validation_messages(), Vec::<String>::new());
}

/// For each function of a `&Gpu`, a module of the same name with a test of it on each back end.
macro_rules! on_both_back_ends {
    ($($test:ident),+ $(,)?) => {$(
        mod $test {
            #[test]
            fn software() {
                crate::device::on(lightoven::gpu::BackendChoice::Software, super::$test);
            }

            #[test]
            fn ray_query() {
                crate::device::on(lightoven::gpu::BackendChoice::RayQuery, super::$test);
            }
        }
    )+};
}
pub(crate) use on_both_back_ends;
