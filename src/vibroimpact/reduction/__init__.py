"""The reduced model: Ritz basis, structural modifications, modes that were computed or measured."""
