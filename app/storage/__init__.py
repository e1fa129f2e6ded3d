"""What is kept, and kept private: keys, journals, the library's database, audit, backup."""
