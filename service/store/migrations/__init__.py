"""Schema changes, one file each (alembic); the first creates everything."""
