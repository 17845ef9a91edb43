"""The virtual SERCOS drive."""
