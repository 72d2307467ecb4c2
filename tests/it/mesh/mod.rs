//! The module `mesh`.

mod timing;
