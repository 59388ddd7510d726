//! The backend of PETSc in one process: the contract of backends.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::Arc;

use amontons::contract::assert_backend;
use amontons::linalg::Backend;
use amontons_petsc::{Petsc, Session};

/// One session serves the whole program: PETSc is started once.
#[test]
fn the_backend_keeps_its_contract() {
    let session = Session::start().unwrap_or_else(|failure| panic!("{}", failure.0));
    assert_eq!((session.rank(), session.size()), (0, 1));
    let backend: Arc<dyn Backend> = Arc::new(Petsc::new(&session));
    assert_backend(&backend);
    assert!(!backend.is_collective(), "one process need not agree with others");
    assert!(backend.alone().is_some());
}
